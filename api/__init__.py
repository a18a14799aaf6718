"""HTTP: parse a request, call the core once, present what comes back; nothing knows how to render.

app.py           create_app(settings): what is wired to what
settings.py      ApiSettings, from RAYSVC_...; limit_settings.py: what of it says what is too much
problems.py      the one table from exceptions to RFC 9457 problems
body_limit.py    no body is read beyond its limit
json_bodies.py   strict JSON; forms.py: uploads
schemas.py       what requests and answers look like
openapi_schema.py  what the document says besides; examples.py, answer_examples.py
negotiation.py   Accept, Prefer, ETag
routes/          one file per resource
"""
