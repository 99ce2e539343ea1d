/* The cards of all people, for the list of people. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/web/api/access/access.h"
#include "enroll/web/api/person.h"

/* What a person without a stored credential has. */
static const char none[] = ",\"cards\":[],\"enabled\":true";

struct entry {
    char *name, *members;
};

struct web_api_cards {
    struct entry *entries; /* by name */
    size_t n, room;
};

static int by_name(const void *a, const void *b)
{
    return strcmp(((const struct entry *)a)->name, ((const struct entry *)b)->name);
}

static int add(struct web_api_cards *cards, const char *name, const char *credential)
{
    if (cards->n == cards->room) {
        const size_t room = cards->room ? 2 * cards->room : 64;
        struct entry *more = realloc(cards->entries, room * sizeof *more);
        if (!more) {
            return -ENOMEM;
        }
        cards->entries = more;
        cards->room = room;
    }
    struct entry entry = {strdup(name), web__access_members(credential)};
    if (!entry.name || !entry.members) {
        free(entry.name);
        free(entry.members);
        return -EBADMSG;
    }
    cards->entries[cards->n++] = entry;
    return 0;
}

int web__api_cards_read(sd_bus_message *reply, struct web_api_cards **out)
{
    const char *name, *credential;
    struct web_api_cards *cards = calloc(1, sizeof *cards);
    int r = cards ? sd_bus_message_enter_container(reply, 'a', "(ss)") : -ENOMEM;
    while (r >= 0 && (r = sd_bus_message_read(reply, "(ss)", &name, &credential)) > 0) {
        r = add(cards, name, credential);
    }
    if (r < 0) {
        web__api_cards_free(cards);
        return r;
    }
    if (cards->n > 0) {
        qsort(cards->entries, cards->n, sizeof *cards->entries, by_name);
    }
    *out = cards;
    return 0;
}

const char *web__api_cards_of(const struct web_api_cards *cards, const char *person)
{
    const struct entry wanted = {.name = (char *)(uintptr_t)person};
    const struct entry *found = cards->n == 0 ? NULL
                                              : bsearch(&wanted, cards->entries, cards->n,
                                                        sizeof wanted, by_name);
    return found ? found->members : none;
}

void web__api_cards_free(struct web_api_cards *cards)
{
    for (size_t i = 0; cards && i < cards->n; i++) {
        free(cards->entries[i].name);
        free(cards->entries[i].members);
    }
    if (cards) {
        free(cards->entries);
    }
    free(cards);
}
