"""The command line: a module per command, which declares its arguments and runs it."""
