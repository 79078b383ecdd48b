"""Questions of `flexmb new young`, and the deck that the answers give."""
