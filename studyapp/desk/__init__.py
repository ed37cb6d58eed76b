"""The desk: all studies of a lab in the browser, behind one login.

It is a server like that of a single study, with its own accounts. Each study is served below its
folder's name with its own accounts; people are matched by an identity, never by a name. Pages call
the same functions as the command line.
"""
