"""A plugin of pytest: ``--budget`` CPU seconds, after which no further test begins."""

import time


def pytest_addoption(parser):
    parser.addoption("--budget", type=float, required=True)


def pytest_runtest_teardown(item):
    if time.process_time() > item.config.getoption("--budget"):
        item.session.shouldstop = "the budget is spent"
