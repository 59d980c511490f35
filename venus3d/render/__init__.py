"""Named shapes of what is seen, and pictures of them; independent of the browser."""
