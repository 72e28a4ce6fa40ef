"""What all tests of the module need."""

import signal

# Where the tests run in the background, a shell has them ignore Ctrl-C, with which some interrupt long calls.
signal.signal(signal.SIGINT, signal.default_int_handler)
