#!/usr/bin/python3
"""Prints the state of an appliance, who is enrolled, and the visits of its log, over the bus.

    visits.py [ADDRESS]

ADDRESS is that of a message bus; without it, the system bus. The program needs Debian's package
python3-dbus. The policy of the bus decides who may call the daemon: on an appliance, root and the
members of the group isotherm.
"""
import json
import sys

import dbus
import dbus.bus

SERVICE = "org.isotherm.Isotherm"
OBJECT = "/org/isotherm/Door0"
INTERFACE = "org.isotherm.Door"
RECORDS_MAX = 1000  # of one call of ReadLog


def connect(address):
    """Returns the door of the appliance on the system bus, or on the bus at an address."""
    bus = dbus.bus.BusConnection(address) if address else dbus.SystemBus()
    return dbus.Interface(bus.get_object(SERVICE, OBJECT, introspect=False), INTERFACE)


def print_state(status):
    """Prints some keys of GetStatus() -> a{sv}."""
    for key in "version", "sensor-state", "door-state", "people":
        print(f"{key}: {status[key]}")


def print_people(door):
    """Prints ListPeople() -> a(sxxxu): name, enrolled, valid from, valid until, templates."""
    for name, _enrolled, _valid_from, _valid_until, templates in door.ListPeople():
        print(f"enrolled: {name}, {templates} template(s)")


def print_visits(door, last):
    """Prints the visits of ReadLog(t from, u max) -> as; each record is a JSON object."""
    first = max(1, last - RECORDS_MAX + 1)
    for text in door.ReadLog(dbus.UInt64(first), dbus.UInt32(RECORDS_MAX)):
        record = json.loads(text)
        if record["event"] == "visit":
            who = record.get("person") or "(unknown)"
            print(f"visit: {record['time']} {record['verdict']} {who}, {record['reason']}")


def main():
    """Returns the exit code."""
    try:
        door = connect(sys.argv[1] if len(sys.argv) > 1 else None)
        status = door.GetStatus()
        print_state(status)
        print_people(door)
        print_visits(door, int(status["log-sequence"]))
    except dbus.exceptions.DBusException as error:
        print(f"{sys.argv[0]}: {error.get_dbus_message()}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
