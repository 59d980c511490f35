"""The pages, one folder each: options, state, view model, view, texts, and how to run it."""
