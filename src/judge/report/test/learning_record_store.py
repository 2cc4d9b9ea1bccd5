# SPDX-License-Identifier: Apache-2.0
"""A learning record store for the tests, with faults on demand: learning_record_store.py LOG FAULT... [--tls CERTIFICATE KEY]

Prints its port. Takes POST /xapi/statements as xAPI 1.0.3 says, and keeps each statement's id in LOG with how often it arrived. Each
fault is used for one request, then all goes well: 500, 503 (with Retry-After), 429, slow, half (closes in the middle of its answer),
lost (keeps the statement and closes without an answer), silent (closes at once), conflict (409), refuse (400).
"""

import base64
import http.server
import json
import ssl
import sys
import time

arguments = sys.argv[1:]
tls = None
if "--tls" in arguments:
    at = arguments.index("--tls")
    tls = arguments[at + 1 : at + 3]
    del arguments[at:]
log_path, faults = arguments[0], arguments[1:]
kept = {}


def keep(statement):
    known = kept.get(statement["id"])
    if known is not None and known != statement:
        return 409
    kept[statement["id"]] = statement
    with open(log_path, "a", encoding="utf-8") as log:
        log.write(json.dumps({"id": statement["id"], "new": known is None}) + "\n")
    return 200


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def answer(self, status, headers=(), body=b"[]"):
        self.send_response(status)
        for name, value in headers:
            self.send_header(name, value)
        self.send_header("X-Experience-API-Version", "1.0.3")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        if self.path != "/xapi/statements":
            return self.answer(404)
        if self.headers.get("X-Experience-API-Version") != "1.0.3" or self.headers.get("Content-Type") != "application/json":
            return self.answer(400)
        if self.headers.get("Authorization") != "Basic " + base64.b64encode(b"user:pass:word").decode():
            return self.answer(401)
        statement = json.loads(body)
        fault = faults.pop(0) if faults else ""
        if fault in ("500", "503", "429"):
            return self.answer(int(fault), [("Retry-After", "1")] if fault == "503" else [])
        if fault == "slow":
            time.sleep(3)
            return None
        if fault == "silent":
            self.close_connection = True
            return None
        if fault == "refuse":
            return self.answer(400, body=b"no such verb")
        status = keep(statement)
        if fault == "conflict":
            status = 409
        if fault == "lost":
            self.close_connection = True
            return None
        if fault == "half":
            self.wfile.write(b"HTTP/1.1 200 OK\r\nContent-Length: 40\r\n\r\n[")
            self.close_connection = True
            return None
        return self.answer(status)

    def log_message(self, *_):
        pass


server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
if tls:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(*tls)
    server.socket = context.wrap_socket(server.socket, server_side=True)
print(server.server_address[1], flush=True)
server.serve_forever()
