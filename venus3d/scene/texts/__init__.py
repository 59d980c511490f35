"""All that the pages say, in one folder: to translate them, translate these modules.

One module for each page. What the engine says about poses is in `engine/words.py`.
"""
