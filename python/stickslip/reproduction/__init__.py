"""The paper's simulations redone, and its statements tested.

In the order of the data: `settings` says what the paper leaves open, `points` what it varies, and
simulates; `survey` goes through all settings, `strokes` looks into single runs; `criteria` is the
table of the paper's statements, with the fits of `lines`; `statements` judges them, and chooses the
reference; `findings` says what else was found; `curves` and `motions` make the figures, `page`
writes it all up, and `study` is the function `stickslip.reproduce`. `setting_search` searches the
settings continuously.
"""
