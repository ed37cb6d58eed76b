"""The pages of a participant.

Every page is plain HTML; its next step is a ``<form method="post">``. Scripts make it pleasant,
and report what was played. No page needs a cookie: a random token in the address
identifies the participant. What programs may rely on:

==============================  ================================================================
``GET /``                       the first page: eligibility where the study asks for it, whose
                                form posts to ``/consent`` and leads to the consent page, or
                                back to a study session already begun; else consent at once. The
                                consent form posts to ``/`` and leads to ``/take/<token>``. Both
                                forms carry ``visit`` and the names that stood in the address, by
                                which a recruiter or an invitation sends somebody (see
                                `studyapp.web.participants.recruiter_names`); questions about the
                                participant are fields ``form:<question>``, and the consent form
                                carries those of eligibility unseen.
``GET /take/<token>``           where the participant stands: sound check, questions,
                                instructions, a trial, a break, the end.
``POST /take/<token>/sound-check``  the form ``<form id="sound-check">``: ``digits`` as they are
                                spoken in the ``src`` of its page's ``<audio>``.
``POST /take/<token>/form/<stage>``  more such questions, ``demographics`` or ``closing``.
``POST /take/<token>/begin``    the instructions' form; after a wrong first try it holds a hidden
                                ``tries`` too.
``POST /take/<token>/break``    the form ``<form id="break">``: ``position`` alone, of the trial
                                that comes after the break.
``POST /take/<token>/answers``  the trial's form ``<form id="answers">``: a hidden ``trial`` and
                                for each question one radio group of its name, values -2 (clearly
                                A) to 2 (clearly B); an answer about one video is named
                                ``<question>:<number>``, reasons ticked beside an answer
                                ``<its name>:reasons``, for an order ``<question>:reasons``.
                                The same answers may be sent twice.
``POST /take/<token>/unplayable``  the form ``<form id="unplayable">``: ``trial``, and ``video``,
                                one of the tokens that its buttons send; a trial of one video
                                needs none. ``error`` is the code of the browser's media error;
                                without one, a long stall must have been reported.
``POST`` the ``data-watched-url`` of ``<video id="pair">``
                                JSON ``{"batch": n, "intervals": [[from, to], ...]}``, seconds of
                                the video that were played; n counts the reports of a video from
                                0. How they were played may be told beside them, as in
                                `studyapp.session.watch_evidence.Report`. The answer
                                holds ``missing``, the seconds still to be played.
``POST /take/<token>/withdraw``  the form of the page at that address, linked from every other.
``GET /media/<video token>.mp4``  the ``src`` of ``<video id="pair">``, which also states its
                                length as ``data-duration``.
``GET /healthz``                200 while the database answers, 503 while it does not.
``<output id="completion-code">``  on the last page, the completion code; beside it, ``#leave`` is
                                the link or the form that leads back to a recruiter's site.
==============================  ================================================================

Below a path of the host (of ``--address``) all these addresses begin with it; ``/healthz``
answers beside it as well.

Refusals are pages (or JSON, where the request accepts that) with status 403, 404, 409 or 422;
they change nothing. Too many reports of what was played get status 429; the same report is accepted
after the seconds that ``Retry-After`` tells.
"""
