"""Parameter sweeps: many scenarios, one summary each.

In the order of the data: `points` says which scenarios, `worker` simulates some of them, `crew`
brings them to threads or to an executor, `schedule` keeps all of those busy, `results` collects,
`checkpoint` keeps a file, `dataset` labels, and `run_sweep` is the function `stickslip.sweep`.
"""
