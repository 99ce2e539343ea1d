#!/usr/bin/python3
"""A small client of the web server, for tests: sends one request over TLS to this machine.

usage: web_client.py FINGERPRINT COOKIE METHOD PATH [JSON]

It talks only to the server whose certificate has this SHA-256 fingerprint ("AB:CD:..."). COOKIE is a file: the session in it is sent, and a
session that the server begins is written into it. PATH is below /api/v1. The variable ORIGIN replaces the origin of the request.

Prints the status, such as 201, and below it the body. Ends with 1 if there is no such server.
"""
import hashlib
import http.client
import os
import ssl
import sys

HOST, PORT = "127.0.0.1", 8443


def fingerprint(connection):
    digest = hashlib.sha256(connection.sock.getpeercert(binary_form=True)).hexdigest().upper()
    return ":".join(digest[i : i + 2] for i in range(0, len(digest), 2))


def headers_of(cookie):
    headers = {"Origin": os.environ.get("ORIGIN", f"https://{HOST}:{PORT}"), "Content-Type": "application/json"}
    if os.path.exists(cookie):
        with open(cookie, encoding="ascii") as file:
            headers["Cookie"] = file.read()
    return headers


def main():
    expected, cookie, method, path = sys.argv[1:5]
    body = sys.argv[5] if len(sys.argv) > 5 else None
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE  # no authority knows the server; its fingerprint is compared below
    connection = http.client.HTTPSConnection(HOST, PORT, timeout=20, context=context)
    connection.connect()
    if fingerprint(connection) != expected:
        sys.exit(f"the certificate has the fingerprint {fingerprint(connection)}, not {expected}")
    connection.request(method, "/api/v1" + path, body=body, headers=headers_of(cookie))
    response = connection.getresponse()
    session = response.getheader("Set-Cookie")
    if session:
        with open(cookie, "w", encoding="ascii") as file:
            file.write(session.split(";")[0])
    print(response.status)
    print(response.read().decode())


try:
    main()
except (OSError, http.client.HTTPException) as fault:
    sys.exit(f"no answer at {HOST}:{PORT}: {fault}")
