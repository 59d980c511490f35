"""The teaching page: a pose set by sliders, its four steps, lessons."""
