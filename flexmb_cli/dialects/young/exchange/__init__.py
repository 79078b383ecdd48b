"""A YOUNG deck of rigid bodies to and from other dialects."""
