"""The pages, a folder each: options, state, view model, view, texts, and how it is run."""
