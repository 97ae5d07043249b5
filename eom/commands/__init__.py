"""The commands of `eom`: one module a group; heavy packages are imported where they are used.

In: arguments of a command line. Out: text, files, exit statuses.
Imports: `codegen.*`, `eom.*`.
"""
