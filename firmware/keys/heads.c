#include "firmware/keys/heads.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"

enum { CLAIMS_MAX = 16 };

/* The knowledge of one file about the stores. */
struct claim {
    char witness[PATH_MAX];
    struct iso_heads known;
    bool other_link; /* the log has a different link at that sequence */
};

struct store {
    bool found;
    char path[PATH_MAX];
    uint64_t count; /* as it was found, or as it was written since then */
};

struct iso_heads_board {
    pthread_mutex_t lock;
    struct iso_heads now;
    struct store stores[ISO_HEADS];
    struct claim claims[CLAIMS_MAX];
    size_t n;
};

static uint8_t *put_counts(const struct iso_heads *heads, uint8_t *p)
{
    for (int i = 0; i < ISO_HEADS; i++) {
        p = iso_put_u64(p, heads->count[i]);
    }
    return p;
}

void iso_heads_put(const struct iso_heads *heads, uint8_t bytes[ISO_HEADS_BYTES])
{
    (void)iso_put_bytes(put_counts(heads, bytes), heads->link, sizeof heads->link);
}

void iso_heads_put_counts(const struct iso_heads *heads, uint8_t bytes[ISO_HEADS_COUNT_BYTES])
{
    (void)put_counts(heads, bytes);
}

struct iso_heads iso_heads_get_counts(const uint8_t bytes[ISO_HEADS_COUNT_BYTES])
{
    struct iso_heads heads = {{0}, {0}};
    for (size_t i = 0; i < ISO_HEADS; i++) {
        heads.count[i] = iso_get_u64(bytes + 8 * i);
    }
    return heads;
}

struct iso_heads iso_heads_get(const uint8_t bytes[ISO_HEADS_BYTES])
{
    struct iso_heads heads = iso_heads_get_counts(bytes);
    memcpy(heads.link, bytes + ISO_HEADS_COUNT_BYTES, sizeof heads.link);
    return heads;
}

int iso_heads_board_new(struct iso_heads_board **out)
{
    struct iso_heads_board *board = calloc(1, sizeof *board);
    if (!board) {
        return -ENOMEM;
    }
    if (pthread_mutex_init(&board->lock, NULL)) {
        free(board);
        return -ENOMEM;
    }
    *out = board;
    return 0;
}

void iso_heads_board_free(struct iso_heads_board *board)
{
    if (board) {
        (void)pthread_mutex_destroy(&board->lock);
        free(board);
    }
}

/* ---- opening ---- */

static void raise_to(struct iso_heads *now, enum iso_head head, uint64_t count, const uint8_t *link)
{
    if (count >= now->count[head]) {
        now->count[head] = count;
        if (link) {
            memcpy(now->link, link, sizeof now->link);
        }
    }
}

void iso_heads_found(struct iso_heads_board *board, enum iso_head head, const char *path,
                     uint64_t count)
{
    (void)pthread_mutex_lock(&board->lock);
    struct store *store = &board->stores[head];
    store->found = true;
    store->count = count;
    (void)snprintf(store->path, sizeof store->path, "%s", path);
    /* The count of the log is raised by iso_heads_wrote, together with its link. */
    if (head != ISO_HEAD_LOG) {
        raise_to(&board->now, head, count, NULL);
    }
    (void)pthread_mutex_unlock(&board->lock);
}

/* Returns the claim of this witness, or a new one; NULL if there is no room. A witness without a
 * claim still raises the counts of the board, but iso_heads_check does not compare its knowledge.
 */
static struct claim *claim_of(struct iso_heads_board *board, const char *witness)
{
    for (size_t i = 0; i < board->n; i++) {
        if (strcmp(board->claims[i].witness, witness) == 0) {
            return &board->claims[i];
        }
    }
    return board->n < CLAIMS_MAX ? &board->claims[board->n++] : NULL;
}

void iso_heads_claim(struct iso_heads_board *board, const char *witness,
                     const struct iso_heads *known)
{
    (void)pthread_mutex_lock(&board->lock);
    struct claim *claim = claim_of(board, witness);
    if (claim) {
        (void)snprintf(claim->witness, sizeof claim->witness, "%s", witness);
        claim->known = *known;
        claim->other_link = false;
    }
    for (int i = 0; i < ISO_HEADS; i++) {
        raise_to(&board->now, (enum iso_head)i, known->count[i],
                 i == ISO_HEAD_LOG ? known->link : NULL);
    }
    (void)pthread_mutex_unlock(&board->lock);
}

void iso_heads_record(struct iso_heads_board *board, uint64_t sequence,
                      const uint8_t link[ISO_HEADS_LINK_BYTES])
{
    (void)pthread_mutex_lock(&board->lock);
    for (size_t i = 0; i < board->n; i++) {
        struct claim *claim = &board->claims[i];
        if (sequence > 0 && claim->known.count[ISO_HEAD_LOG] == sequence &&
            memcmp(claim->known.link, link, ISO_HEADS_LINK_BYTES) != 0) {
            claim->other_link = true;
        }
    }
    (void)pthread_mutex_unlock(&board->lock);
}

/* The code of the fault that a store is old. */
static const enum iso_fault_code codes[ISO_HEADS] = {
    [ISO_HEAD_GALLERY] = ISO_FAULT_GALLERY_OLD,
    [ISO_HEAD_LOG] = ISO_FAULT_LOG_OLD,
    [ISO_HEAD_LOCKOUT] = ISO_FAULT_LOCKOUT_OLD,
    [ISO_HEAD_RING] = ISO_FAULT_KEY_RING_OLD,
};

static int check_claim(const struct iso_heads_board *board, const struct claim *claim,
                       struct iso_fault *fault)
{
    for (int i = 0; i < ISO_HEADS; i++) {
        const struct store *store = &board->stores[i];
        if (store->found && store->count < claim->known.count[i]) {
            return iso_fault_set_code(
                fault, codes[i], -ESTALE,
                "%s: from an earlier time: it is at %" PRIu64 ", and %s knows of %" PRIu64
                "; put the newest in its place (or see --accept-state)",
                store->path, store->count, claim->witness, claim->known.count[i]);
        }
    }
    return claim->other_link
               ? iso_fault_set_code(
                     fault, ISO_FAULT_LOG_OLD, -ESTALE,
                     "%s: record %" PRIu64
                     " is not the one that %s knows; put the newest in its place (or see "
                     "--accept-state)",
                     board->stores[ISO_HEAD_LOG].path, claim->known.count[ISO_HEAD_LOG],
                     claim->witness)
               : 0;
}

int iso_heads_check(struct iso_heads_board *board, struct iso_fault *fault)
{
    int error = 0;
    (void)pthread_mutex_lock(&board->lock);
    for (size_t i = 0; !error && i < board->n; i++) {
        error = check_claim(board, &board->claims[i], fault);
    }
    (void)pthread_mutex_unlock(&board->lock);
    return error;
}

void iso_heads_accept(struct iso_heads_board *board)
{
    (void)pthread_mutex_lock(&board->lock);
    board->n = 0;
    board->now = (struct iso_heads){{0}, {0}};
    for (int i = 0; i < ISO_HEADS; i++) {
        if (board->stores[i].found && i != ISO_HEAD_LOG) {
            board->now.count[i] = board->stores[i].count;
        }
    }
    (void)pthread_mutex_unlock(&board->lock);
}

/* ---- writing ---- */

struct iso_heads iso_heads_now(struct iso_heads_board *board)
{
    (void)pthread_mutex_lock(&board->lock);
    const struct iso_heads now = board->now;
    (void)pthread_mutex_unlock(&board->lock);
    return now;
}

void iso_heads_wrote(struct iso_heads_board *board, enum iso_head head, uint64_t count,
                     const uint8_t *link)
{
    (void)pthread_mutex_lock(&board->lock);
    struct store *store = &board->stores[head];
    raise_to(&board->now, head, count, link);
    store->count = count > store->count ? count : store->count;
    (void)pthread_mutex_unlock(&board->lock);
}
