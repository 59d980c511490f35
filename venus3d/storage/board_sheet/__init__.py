"""A board to print: laid out on paper (`sheet`), written as PDF, SVG or PNG (`files`)."""
