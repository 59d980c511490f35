"""The teaching page: a pose by sliders, its four steps, lessons."""
