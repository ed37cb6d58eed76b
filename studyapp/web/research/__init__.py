"""The pages of researchers, under ``/research``.

Unlike participants, researchers log in and have a cookie: a random token that is sent to these
pages alone. Everything else about a login is in the database. One table
(`studyapp.web.research.pages`) says what each page requires, and is checked before the page does
anything.
"""
