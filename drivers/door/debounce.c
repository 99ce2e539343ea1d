#include "drivers/door/debounce.h"

void iso_debounce_init(struct iso_debounce *debounce, int64_t window_ns, bool level, int64_t now_ns)
{
    *debounce = (struct iso_debounce){
        .window_ns = window_ns,
        .level = level,
        .was_active = level,
        .raw = level,
        .raw_since_ns = now_ns,
    };
}

void iso_debounce_edge(struct iso_debounce *debounce, bool level, int64_t t_ns)
{
    const int64_t since_ns = debounce->raw_since_ns;
    const int64_t at_ns = t_ns > since_ns ? t_ns : since_ns;
    if (level == debounce->raw) {
        return; /* the edge in between was lost */
    }
    iso_debounce_advance(debounce, at_ns);
    debounce->raw = level;
    debounce->raw_since_ns = at_ns;
}

void iso_debounce_advance(struct iso_debounce *debounce, int64_t now_ns)
{
    if (now_ns - debounce->raw_since_ns >= debounce->window_ns) {
        debounce->level = debounce->raw;
        debounce->was_active |= debounce->level;
    }
}

int64_t iso_debounce_due_ns(const struct iso_debounce *debounce)
{
    return debounce->raw == debounce->level ? INT64_MAX
                                            : debounce->raw_since_ns + debounce->window_ns;
}

bool iso_debounce_take(struct iso_debounce *debounce)
{
    const bool active = debounce->was_active;
    debounce->was_active = debounce->level;
    return active;
}
