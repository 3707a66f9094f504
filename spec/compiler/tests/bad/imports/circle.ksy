# Imports itself by way of another.
meta:
  id: circle
  imports:
    - circle_back
