"""The desk: all studies of a lab in the browser, behind one login.

It is a server like that of one study, whose accounts are the desk's own. Each study lies below
its folder's name with the accounts it has; who belongs to it is known by an identity, never by a
name. What a page does is what the command line does, by the same functions.
"""
