"""Kane's equations of trees."""
