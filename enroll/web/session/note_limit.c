#include "enroll/web/session/note_limit.h"

#include <stdio.h>
#include <string.h>

/* The place of the account, or the one that was not used for the longest time: there are as many
 * places as accounts, so this one is of an account that was removed. */
static struct web_note_count *find(struct web_note_limit *limit, const char *account)
{
    struct web_note_count *oldest = &limit->items[0];
    for (size_t i = 0; i < WEB_ACCOUNTS_MOST; i++) {
        struct web_note_count *item = &limit->items[i];
        if (strcmp(item->account, account) == 0) {
            return item;
        }
        if (!*item->account ? *oldest->account != '\0'
                            : *oldest->account && item->last_ns < oldest->last_ns) {
            oldest = item;
        }
    }
    *oldest = (struct web_note_count){.used = 0};
    (void)snprintf(oldest->account, sizeof oldest->account, "%s", account);
    return oldest;
}

bool web_note_limit_take(struct web_note_limit *limit, const char *account, int64_t now_ns,
                         uint32_t *left_out)
{
    struct web_note_count *count = find(limit, account);
    const double passed = (double)(now_ns - count->last_ns) / 1e9 / (double)WEB_NOTE_EVERY_S;
    count->used = count->used > passed ? count->used - passed : 0.0;
    count->last_ns = now_ns;
    if (count->used + 1.0 > (double)WEB_NOTES_AT_ONCE) {
        count->left_out += count->left_out < UINT32_MAX;
        return false;
    }
    count->used += 1.0;
    *left_out = count->left_out;
    count->left_out = 0;
    return true;
}
