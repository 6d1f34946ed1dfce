"""The paper's simulations redone, and its statements tested.

In the order of the data: `settings` says what the paper leaves open, `scans` what it varies,
`points` simulates, `survey` goes through all settings, `strokes` looks into single runs,
`motion_criteria` and `curve_criteria` turn the paper's sentences into conditions, `verdicts` and
`statements` judge, `reference` chooses, `curves` and `motions` make the figures' data, `page`
writes it all up, and `study` is the function `stickslip.reproduce`.
"""
