/* The state of an open key ring. Internal to firmware/keys. */
#ifndef ISO_FIRMWARE_KEYS_KEY_RING_STATE_H
#define ISO_FIRMWARE_KEYS_KEY_RING_STATE_H

#include <limits.h>
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/keys/heads.h"
#include "firmware/keys/key_ring.h"
#include "firmware/keys/key_slots.h"

struct iso_key_ring {
    char path[PATH_MAX], file[PATH_MAX];
    bool credential;
    bool beside;              /* the key is not in its place yet but in FILE.new */
    bool unsure;              /* after an error of the disk it is not known which ring is there */
    pthread_mutex_t changing; /* protects all members below, except for reading the slots */
    struct iso_seal_key master;
    struct iso_key_slots slots;
    struct iso_key_list draft; /* the keys that are about to be written */
    uint64_t number;           /* number of the file on the disk; 0: format 1 */
    struct iso_heads_board *board;
};

/* ---- the file of the ring (key_ring_file.c) ---- */

/* The largest size of the file. */
size_t iso__key_ring_file_bytes(void);

/* Writes the draft, sealed with `master`. The keys of the draft and `master` come into use when the
 * new file is in its place. After an error of the disk the ring is as before, or `unsure`. The
 * draft is wiped. */
int iso__key_ring_commit(struct iso_key_ring *ring, const struct iso_seal_key *master,
                         struct iso_fault *fault);

/* Reads the keys of a file that `master` opens. -EKEYREJECTED: it does not open the file. */
int iso__key_ring_open_with(struct iso_key_ring *ring, const struct iso_seal_key *master,
                            const uint8_t *bytes, size_t size);

#endif
