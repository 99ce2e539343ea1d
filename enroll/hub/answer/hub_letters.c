#include "enroll/hub/answer/hub_letters.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/store/hub_door.h"

/* A message that is emitted after the commit. */
struct held {
    struct held *next;
    char topic[ISO_FLEET_TOPIC_SIZE];
    bool retain;
    size_t size;
    unsigned char bytes[];
};

struct work {
    struct hub_store *store;
    const struct hub_letter *letters[HUB_LETTERS_MOST];
    size_t n;
    struct held *first, **end;
};

static void drop_held(struct work *w)
{
    while (w->first) {
        struct held *held = w->first;
        w->first = held->next;
        free(held);
    }
    w->end = &w->first;
}

static int hold(void *context, const char *topic, const void *bytes, size_t size, bool retain)
{
    struct work *w = context;
    struct held *held = malloc(sizeof *held + size);
    if (!held) {
        return -ENOMEM;
    }
    held->next = NULL;
    held->retain = retain;
    held->size = size;
    (void)snprintf(held->topic, sizeof held->topic, "%s", topic);
    memcpy(held->bytes, bytes, size);
    *w->end = held;
    w->end = &held->next;
    return 0;
}

bool hub_letter_is_joint(const void *bytes, size_t size)
{
    enum iso_fleet_kind kind;
    return iso_fleet_kind_of(bytes, size, &kind) == 0 &&
           (kind == ISO_FLEET_QUESTION || kind == ISO_FLEET_EVENTS);
}

static int take(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    const struct hub_emit emit = {.emit = hold, .context = w};
    int error = 0;
    drop_held(w); /* of an attempt that has failed */
    for (size_t i = 0; !error && i < w->n; i++) {
        const struct hub_letter *letter = w->letters[i];
        error = letter->bytes
                    ? hub_take(w->store, &letter->door, letter->bytes, letter->size, &emit, fault)
                    : hub_door_set_online(w->store, &letter->door, letter->online, fault);
    }
    /* A QUESTION alone need not wait for the disk, and says so for the whole transaction; but an
     * event that is acknowledged has to be on it. */
    return error ? error
                 : hub_db_script(w->store->db, "SET LOCAL synchronous_commit TO DEFAULT", fault);
}

/* By the door, and the messages of one door in their order. */
static int compare(const void *a, const void *b)
{
    const struct hub_letter *x = *(const struct hub_letter *const *)a;
    const struct hub_letter *y = *(const struct hub_letter *const *)b;
    const int order = memcmp(&x->door, &y->door, sizeof x->door);
    return order ? order : (x > y) - (x < y);
}

static int emit_held(const struct work *w, const struct hub_emit *emit, struct iso_fault *fault)
{
    int error = 0;
    for (const struct held *held = w->first; !error && held; held = held->next) {
        error = emit->emit(emit->context, held->topic, held->bytes, held->size, held->retain);
    }
    return error ? iso_fault_set(fault, error, "the broker: the answers to doors could not be sent")
                 : 0;
}

int hub_take_letters(struct hub_store *store, const struct hub_letter *letters, size_t n,
                     const struct hub_emit *emit, struct iso_fault *fault)
{
    struct work w = {.store = store};
    bool is_joint = n >= 1 && n <= HUB_LETTERS_MOST;
    w.end = &w.first;
    for (size_t i = 0; is_joint && i < n; i++) {
        is_joint = !letters[i].bytes || hub_letter_is_joint(letters[i].bytes, letters[i].size);
        w.letters[w.n++] = &letters[i];
    }
    if (!is_joint) {
        return iso_fault_set(fault, -EINVAL, "messages of doors that are not taken together");
    }
    /* Every hub locks the rows of the doors in the same order, so that none waits for another in a
     * circle. */
    qsort(w.letters, w.n, sizeof *w.letters, compare);
    int error = hub_db_transaction(store->db, HUB_READ_COMMITTED, take, &w, fault);
    error = error ? error : emit_held(&w, emit, fault);
    drop_held(&w);
    return error;
}
