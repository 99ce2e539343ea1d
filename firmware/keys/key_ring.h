/* The keys of one appliance: numbered keys for its stores in a small file, the ring, which is
 * sealed with one key from outside, the appliance's key.
 *
 * The key of the appliance has 32 bytes. It is one of two:
 *   a credential of the service manager, DIRECTORY/isotherm.key (LoadCredentialEncrypted= of
 *   systemd can bind it to a TPM). To change it, give the new one, and the old one as
 *   isotherm.key.old until the next start is over;
 *   a file that only its owner can read, made at the first start. Anybody who takes the disk has
 *   this key, too, unless the file is on another disk.
 *
 * The keys of a store are rotated in three steps: a new key is made, everything is sealed with it,
 * and the older keys are dropped. (The log seals only new records with it, and drops an older key
 * with its last segment.) The ring holds both meanwhile, so that after a kill at any moment every
 * record has its key. A ring is written whole (iso_data_file_replace), with a number that rises and
 * what it knows of the other stores (heads.h). A ring whose key is gone is never replaced.
 *
 * Several threads may use one ring as long as the keys of one use belong to one thread at a time:
 * that thread makes and drops them, and looks for them. A key that is in the ring does not move.
 * Keys are in locked memory, which is wiped at the end. */
#ifndef ISO_FIRMWARE_KEYS_KEY_RING_H
#define ISO_FIRMWARE_KEYS_KEY_RING_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/keys/heads.h"
#include "firmware/keys/seal.h"

/* The use of a key. The numbers are in the file. */
enum iso_key_use {
    ISO_KEY_GALLERY = 1, /* records of people and templates */
    ISO_KEY_LOG = 2,     /* records of the audit log */
    ISO_KEY_ANCHOR = 3,  /* anchor.h */
    ISO_KEY_SIGN = 4,    /* seed of the Ed25519 pair that signs what is exported */
    ISO_KEY_RECEIVE = 5, /* seed of the X25519 pair for which others seal exports */
    ISO_KEY_PANEL = 6,   /* panel_file.h; made when a panel is configured */
};

enum { ISO_KEY_RING_MOST = 64 };

struct iso_key_place {
    const char *ring;        /* path of the ring */
    const char *file;        /* path of the appliance's key, if it is not a credential */
    const char *credentials; /* directory of credentials; NULL or "": there is none */
};

struct iso_key_ring;

/* Opens the ring, or makes one: with a fresh key file if there is no credential and no file. Ends a
 * change of the appliance's key that was cut short. Errors with a fault:
 *   -ENOKEY       there is a ring, and no key
 *   -EKEYREJECTED the key is another one, or the ring is damaged
 *   -EINVAL       a key that does not have 32 bytes
 *   -EACCES       the file can be read by others; -ENOSPC, -EROFS, -EIO, -ENOMEM, ... */
int iso_key_ring_open(const struct iso_key_place *place, struct iso_key_ring **out,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Wipes and frees it. NULL is accepted. */
void iso_key_ring_close(struct iso_key_ring *ring);

/* The key of this use and number; NULL if there is none. Valid until that key is dropped. */
const struct iso_seal_key *iso_key_ring_find(const struct iso_key_ring *ring, enum iso_key_use use,
                                             uint32_t number);

/* Number of the newest key of this use; 0 if there is none. */
uint32_t iso_key_ring_newest(const struct iso_key_ring *ring, enum iso_key_use use);

/* Makes a key; its number is higher than all before. The ring is on the disk when it returns.
 * -ENOSPC (the disk or the ring is full), -EIO, ...; then nothing has changed. */
int iso_key_ring_add(struct iso_key_ring *ring, enum iso_key_use use, uint32_t *number,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Drops the keys of this use with numbers below `number`. What they have sealed cannot be read any
 * more. */
int iso_key_ring_drop(struct iso_key_ring *ring, enum iso_key_use use, uint32_t number,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Gives the ring another random key of the appliance, in the place of the old file. -EPERM: the key
 * is a credential, which the administrator changes. */
int iso_key_ring_change_key(struct iso_key_ring *ring, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes the ring unchanged, with the next number and the present knowledge. -EIO, -ENOSPC, ... */
int iso_key_ring_renew(struct iso_key_ring *ring, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The board on which the stores that have this ring exchange their counts. Lives as long as the
 * ring. */
struct iso_heads_board *iso_key_ring_board(const struct iso_key_ring *ring);

/* Whether the appliance's key is a credential of the service manager, and not a file. */
bool iso_key_ring_has_credential(const struct iso_key_ring *ring);

#endif
