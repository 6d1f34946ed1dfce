"""The paper's simulations redone, and its statements tested.

In the order of the data: `settings` says what the paper leaves open, `points` what it varies, and
simulates; `survey` goes through all settings, `strokes` looks into single runs; `criteria` says
what a statement is, `motion_criteria` and `curve_criteria` turn the paper's sentences into such;
`verdicts` and `statements` judge, `reference` chooses, `findings` and `flaws` say what else was
found; `curves` and `motions` make the figures, `page` writes it all up, and `study` is the function
`stickslip.reproduce`. `free_settings`, `setting_search` and `setting_evidence` search the settings
continuously.
"""
