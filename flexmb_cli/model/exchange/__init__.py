"""A mechanism of rigid bodies that no dialect owns: what `flexmb convert` carries from deck to deck."""
