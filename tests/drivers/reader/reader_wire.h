/* A wire of two pseudo-terminals: the appliance at one end, a reader at the other, and a thread in
 * between that carries the bytes, and damages some of them. Time is real. */
#ifndef TESTS_DRIVERS_READER_READER_WIRE_H
#define TESTS_DRIVERS_READER_READER_WIRE_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct reader_wire {
    char appliance_path[256]; /* a symbolic link, so that it stays the same */
    char reader_path[64];
    int masters[2], slaves[2]; /* of the appliance's end, and of the reader's */
    int end_fd;
    pthread_t thread;
    atomic_uint loss; /* of so many pieces one is damaged or lost; 0: none; 1: all are lost */
    uint32_t dice;
};

/* Makes a wire; the link is made in `directory`. */
void reader_wire_open(struct reader_wire *wire, const char *directory);
void reader_wire_close(struct reader_wire *wire);

/* Takes the appliance's end away, as if its adapter were unplugged, or plugs in a new one. */
void reader_wire_unplug(struct reader_wire *wire);
void reader_wire_plug(struct reader_wire *wire);

#endif
