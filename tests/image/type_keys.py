#!/usr/bin/env python3
"""Types at the keyboard of a virtual machine what the machine asks for, and takes pictures of its monitor.

usage: type_keys.py LOG MONITOR PICTURES

LOG is the log of the machine's serial line. A line "keys: KEY..." in it has names of keys of QEMU, "picture: NAME" becomes
PICTURES/NAME.png and NAME.ppm.
MONITOR is the socket of QEMU's monitor. It goes on until it is ended."""
import os
import socket
import sys
import time


def ask(monitor, command):
    """Waits for the answer, so that nothing overtakes it."""
    monitor.sendall(command.encode() + b"\n")
    answer = b""
    while not answer.endswith(b"(qemu) "):
        part = monitor.recv(4096)
        if not part:
            sys.exit(0)
        answer += part
    if b"rror" in answer:
        sys.exit(f"type_keys.py: {command}: {answer.decode(errors='replace')}")


def open_monitor(path):
    while True:
        monitor = socket.socket(socket.AF_UNIX)
        try:
            monitor.connect(path)
            break
        except (FileNotFoundError, ConnectionRefusedError):
            monitor.close()
            time.sleep(0.2)
    answer = b""
    while not answer.endswith(b"(qemu) "):
        answer += monitor.recv(4096)
    return monitor


def main():
    log, path, pictures = sys.argv[1:]
    monitor = open_monitor(path)
    with open(log, errors="replace") as lines:
        rest = ""
        while True:
            rest += lines.read()
            *whole, rest = rest.split("\n")
            for line in whole:
                word, _, value = line.strip().partition(": ")
                if word == "keys":
                    for key in value.split():
                        ask(monitor, f"sendkey {key}")
                        time.sleep(0.3)  # sendkey holds the key for 0.1 s
                elif word == "picture":
                    for kind in ("png", "ppm"):
                        ask(monitor, f"screendump {os.path.join(pictures, value)}.{kind} -f {kind}")
            time.sleep(0.2)


main()
