"""Code of the user's own in the loop: found, checked, called so that whatever it does wrong is one line."""
