"""Forward dynamics of trees."""
