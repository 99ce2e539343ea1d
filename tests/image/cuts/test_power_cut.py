#!/usr/bin/env python3
"""Tests power_cut on a log of its own: test_power_cut.py POWER_CUT. Ends with 1 and one line on the first fault."""
import os
import struct
import subprocess
import sys
import tempfile

SECTOR = 512
FLUSH, FUA, DISCARD = 1, 2, 4
DISK = 4096  # sectors
ESP, ROOT, TREE = 100, 1000, 2000  # where the partitions begin; the first two have 500 sectors, the third 100
program = sys.argv[1]


def say_fault(words):
    sys.exit(f'test_power_cut.py: {words}')


def run(*words):
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True)


def works(*words):
    done = run(*words)
    if done.returncode != 0:
        say_fault(f'power_cut {words}: {done.stderr}')
    return done.stdout


def make_entries():
    """Two stages of writes with flushes, an installation between marks, and a discard. Every sector has bytes of its own."""
    entries = []

    def write(sector, count, flags=0):
        number = len(entries)
        data = b''.join(struct.pack('<II', number, i) * (SECTOR // 8) for i in range(count))
        entries.append((sector, count, flags, data))

    def mark(name):
        entries.append((40, 1, 0, f'isotherm-mark {name}\n'.encode().ljust(SECTOR, b'\0')))

    def flush():
        entries.append((0, 0, FLUSH, b''))

    for i in range(10):
        write(3000 + i, 3)
    mark('install-b')
    write(ESP, 2)
    flush()
    for i in range(20):
        write(ROOT + 8 * i, 8)
        if i % 7 == 6:
            flush()
    write(TREE, 4)
    flush()
    write(3000, 8)
    write(ESP, 1)
    write(ESP + 7, 1, FUA)
    flush()
    mark('start')
    for i in range(12):
        write(3000 + i % 3, 2)
        if i == 5:
            entries.append((3100, 8, DISCARD, b''))
            flush()
    mark('end')
    write(3005, 1)
    flush()
    return entries


def write_log(path, entries):
    with open(path, 'wb') as log:
        log.write(struct.pack('<QQQI', 0x6a736677736872, 1, len(entries), SECTOR).ljust(SECTOR, b'\0'))
        for sector, count, flags, data in entries:
            log.write(struct.pack('<QQQQ', sector, count, flags, 0).ljust(SECTOR, b'\0') + data)


def read_log(path):
    """The entries that a log has, as make_entries() gives them."""
    with open(path, 'rb') as log:
        content = log.read()
    count, place, entries = struct.unpack_from('<Q', content, 16)[0], SECTOR, []
    for _ in range(count):
        sector, size, flags, _ = struct.unpack_from('<QQQQ', content, place)
        length = 0 if flags & DISCARD else size * SECTOR
        entries.append((sector, size, flags, content[place + SECTOR:place + SECTOR + length]))
        place += SECTOR + length
    return entries


def sectors_of(entry):
    sector, count, flags, data = entry
    return {} if flags & DISCARD else {sector + i: data[i * SECTOR:(i + 1) * SECTOR] for i in range(count)}


def points_are_sound(path, parts, entries):
    text = works('points', path, parts, 200, 7)
    if text != works('points', path, parts, 200, 7) or text == works('points', path, parts, 200, 8):
        say_fault('points do not depend on the seed alone')
    points = [(int(a), int(b), int(c), d) for a, b, c, d in (line.split() for line in text.splitlines())]
    if len(points) != 200 or points != sorted(points, key=lambda point: point[0]):
        say_fault('the points are not 200, or not in order')
    for point, flushed, _, _ in points:
        if flushed > point or not (flushed == 0 or entries[flushed - 1][2] & FLUSH) or any(e[2] & FLUSH for e in entries[flushed:point]):
            say_fault(f'{flushed} is not the number of flushed entries at {point}')
    stages = {point[3] for point in points}
    wanted = {'install-b.before', 'install-b.before.esp', 'install-b.slot', 'install-b.between', 'install-b.between.esp', 'install-b.entry', 'start'}
    if not wanted <= stages:
        say_fault(f'no points in {wanted - stages}')
    return points


def cuts_are_sound(path, folder, points, entries):
    image = os.path.join(folder, 'disk')
    seen = {'lost': 0, 'whole': 0, 'torn': 0}
    for point, flushed, seed, _ in points:
        with open(image, 'wb') as disk:
            disk.truncate(DISK * SECTOR)
        works('apply', path, image, 0, flushed)
        works('cut', path, image, flushed, point, seed)
        with open(image, 'rb') as disk:
            content = disk.read()
        possible = {i: {bytes(SECTOR)} for i in range(DISK)}
        for n, entry in enumerate(entries[:point]):
            for sector, data in sectors_of(entry).items():
                possible[sector] = {data} if n < flushed or entry[2] & FUA else possible[sector] | {data}
        for i in range(DISK):
            if content[i * SECTOR:(i + 1) * SECTOR] not in possible[i]:
                say_fault(f'cut at {point}: sector {i} cannot have this')
        for entry in entries[flushed:point]:
            there = [content[s * SECTOR:(s + 1) * SECTOR] == data for s, data in sectors_of(entry).items()]
            if len(there) > 2:
                seen['whole' if all(there) else 'torn' if any(there) else 'lost'] += 1
    if min(seen.values()) == 0:
        say_fault(f'not all kinds of cuts: {seen}')


def mistakes_are_made(path, folder, parts, entries):
    begin, end = (n for n, e in enumerate(entries) if e[3].startswith((b'isotherm-mark install-b', b'isotherm-mark start')))
    out = os.path.join(folder, 'spoilt')
    works('spoil', 'unflushed', path, out, parts, 'root-b', 'install-b', 'start')
    if read_log(out) != [e for n, e in enumerate(entries) if not (begin <= n <= end and e[2] & FLUSH)]:
        say_fault('spoil unflushed does not leave out the flushes alone')
    works('spoil', 'late', path, out, parts, 'root-b', 'install-b', 'start')
    slot = [e for e in entries if ROOT <= e[0] < ROOT + 500]
    rest = [e for e in entries if e not in slot]
    cut = rest.index(entries[end])
    if read_log(out) != rest[:cut] + slot + rest[cut:]:
        say_fault('spoil late does not move the writes to the slot alone')


def faults_are_refused(path, folder):
    bad = os.path.join(folder, 'bad')
    with open(path, 'rb') as log:
        content = log.read()
    for what, bytes_of_it in (('short', content[:-SECTOR]), ('of another kind', b'x' + content[1:]), ('empty', b'')):
        with open(bad, 'wb') as log:
            log.write(bytes_of_it)
        done = run('stages', bad)
        if done.returncode != 1 or done.stderr.count('\n') != 1:
            say_fault(f'a log that is {what} is not refused with one line')
    if run('apply', path, bad, 0, 100000).returncode != 1:
        say_fault('a range beyond the end is not refused')


def main():
    with tempfile.TemporaryDirectory() as folder:
        path, parts = os.path.join(folder, 'log'), os.path.join(folder, 'partitions')
        entries = make_entries()
        write_log(path, entries)
        with open(parts, 'w', encoding='ascii') as file:
            file.write(f'esp {ESP} 500\nroot-b {ROOT} 500\nroot-b-verity {TREE} 100\n')
        cuts_are_sound(path, folder, points_are_sound(path, parts, entries), entries)
        mistakes_are_made(path, folder, parts, entries)
        # The last entry of this log is a flush, which has no data.
        write_log(path, entries[:-1])
        faults_are_refused(path, folder)


main()
