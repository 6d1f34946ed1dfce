"""The paper's simulations redone, and its statements tested.

`settings` has what the paper leaves open and what it varies, `walks` simulates every setting,
`statements` judges the paper's statements by them, `figures` draws, and `study` has the function
`stickslip.reproduce`.
"""
