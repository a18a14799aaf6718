"""HTTP: parse a request, call the core once, present what comes back; nothing knows how to render.

app.py           create_app(settings): what is wired to what
serving.py       the same as `raysvc serve` runs it, with its log
settings.py      ApiSettings, from RAYSVC_...; limit_settings.py: what of it says what is too much
access.py        the one table of routes and scopes, and the guard that reads it
request_ids.py   an id for each request;  request_log.py: a line in the log and in the metrics
logs.py          how the log looks;  metrics.py: what is measured
problems.py      the one table from exceptions to RFC 9457 problems
body_limit.py    no body is read beyond its limit
json_bodies.py   strict JSON; forms.py: uploads
schemas.py       what requests and answers look like
openapi_schema.py  what the document says besides: body_examples.py, answer_examples.py
security_headers.py  what browsers are told
negotiation.py   Accept, Prefer, ETag
routes/          one file per resource
"""
