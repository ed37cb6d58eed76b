"""The pages of researchers, under ``/research``.

Unlike participants, researchers log in, and a cookie says who they are. It is a random token that
is sent to these pages alone; everything else about a login is in the database. What each page
needs is one table (`studyapp.web.research.pages`), asked before any of them does anything.
"""
