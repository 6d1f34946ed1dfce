"""Parameter sweeps: many scenarios, one summary each.

In the order of the data: `points` says which scenarios, `worker` simulates some of them,
`executors` brings them to threads or to an executor, `scheduling` keeps all of those busy,
`results` collects, `checkpoint` keeps a file, `dataset` labels, and `run_sweep` is the function
`stickslip.sweep`.
"""
