# The other half of the circle.
meta:
  id: circle_back
  imports:
    - circle
