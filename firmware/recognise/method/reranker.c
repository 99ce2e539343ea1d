#include "firmware/recognise/method/reranker.h"

#include <errno.h>
#include <sodium.h>
#include <stdlib.h>

enum {
    TEMPLATES = ISO_INDEX_TEMPLATES_MAX,
    SLOTS = 2 * ISO_RERANK_CANDIDATES, /* candidates of this frame, and some of earlier ones */
};

/* A person whose upper faces are in memory. */
struct slot {
    int64_t person; /* 0: the slot is empty */
    uint64_t used;  /* number of the search that used the slot last */
    int n;
    struct iso_upper_face upper[TEMPLATES];
};

struct iso_reranker {
    const void *owner; /* the gallery whose people are in the slots */
    uint64_t version;  /* the version of that gallery */
    uint64_t looks;
    struct slot slots[SLOTS];
    struct iso_template opened[TEMPLATES];
    struct iso_rerank_workspace rerank;
};

int iso_reranker_new(struct iso_reranker **out)
{
    struct iso_reranker *look = calloc(1, sizeof *look);
    if (!look) {
        return -ENOMEM;
    }
    *out = look;
    return 0;
}

void iso_reranker_free(struct iso_reranker *look)
{
    if (look) {
        sodium_memzero(look, sizeof *look);
        free(look);
    }
}

struct iso_rerank_workspace *iso_reranker_workspace(struct iso_reranker *look)
{
    return &look->rerank;
}

static void forget(struct slot *slot)
{
    sodium_memzero(slot->upper, (size_t)slot->n * sizeof *slot->upper);
    slot->person = 0;
    slot->used = 0;
    slot->n = 0;
}

void iso_reranker_forget(struct iso_reranker *look)
{
    for (int i = 0; look && i < SLOTS; i++) {
        forget(&look->slots[i]);
    }
}

static void forget_what_changed(struct iso_reranker *look, const struct iso_candidate_list *among)
{
    if (look->owner == among->owner && look->version == among->version) {
        return;
    }
    iso_reranker_forget(look);
    look->owner = among->owner;
    look->version = among->version;
}

static int open_person(struct iso_reranker *look, const struct iso_candidate_list *among,
                       int64_t person, struct slot *slot)
{
    struct iso_fault fault;
    int n = 0;
    forget(slot);
    const int error = among->templates(among->owner, person, look->opened, TEMPLATES, &n, &fault);
    if (error) {
        return error;
    }
    for (int i = 0; i < n; i++) {
        slot->upper[i] = look->opened[i].upper;
    }
    sodium_memzero(look->opened, (size_t)n * sizeof *look->opened);
    slot->person = person;
    slot->n = n;
    return 0;
}

/* The slot of a person. A new person takes the slot that was not used for the longest time. */
static int find(struct iso_reranker *look, const struct iso_candidate_list *among, int64_t person,
                struct slot **out)
{
    struct slot *slot = &look->slots[0];
    for (int i = 0; i < SLOTS && slot->person != person; i++) {
        struct slot *other = &look->slots[i];
        slot = other->person == person || other->used < slot->used ? other : slot;
    }
    const int error = slot->person == person ? 0 : open_person(look, among, person, slot);
    if (!error) {
        slot->used = look->looks;
        *out = slot;
    }
    return error;
}

int iso_reranker_take(struct iso_reranker *look, const struct iso_metric *metric,
                      const struct iso_candidate_list *among, const struct iso_template *probe,
                      struct iso_search_hit *hits, int n)
{
    if (n < 0 || n > ISO_RERANK_CANDIDATES) {
        return -EINVAL;
    }
    forget_what_changed(look, among);
    look->looks++;
    for (int i = 0; i < n; i++) {
        const struct iso_upper_face *person[TEMPLATES];
        struct slot *slot = NULL;
        const int error = find(look, among, hits[i].person, &slot);
        if (error) {
            return error;
        }
        for (int k = 0; k < slot->n; k++) {
            person[k] = &slot->upper[k];
        }
        hits[i].score = iso_rerank(&look->rerank, metric, &probe->upper, person, slot->n, i,
                                   hits[i].score);
    }
    iso_search_sort(hits, (size_t)n);
    return 0;
}
