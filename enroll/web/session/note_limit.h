/* How often the logins and logouts of an account are put on record one by one. Somebody with a
 * right password could otherwise fill the audit log of the daemon, and make its old records
 * disappear: so an account has WEB_NOTES_AT_ONCE records, and one more every WEB_NOTE_EVERY_S.
 * Those beyond are counted, and the next record says how many they were. Pure: time is an argument.
 */
#ifndef WEB_SESSION_NOTE_LIMIT_H
#define WEB_SESSION_NOTE_LIMIT_H

#include <stdbool.h>
#include <stdint.h>

#include "enroll/web/account/account.h"

enum { WEB_NOTES_AT_ONCE = 20, WEB_NOTE_EVERY_S = 300 };

/* All zero: nothing was recorded yet. */
struct web_note_limit {
    struct web_note_count {
        char account[WEB_ACCOUNT_NAME_SIZE]; /* "": the place is free */
        double used;                         /* of WEB_NOTES_AT_ONCE, at last_ns */
        int64_t last_ns;
        uint32_t left_out; /* since the last record */
    } items[WEB_ACCOUNTS_MOST];
};

/* Whether a login or logout of the account may be recorded now. If so, *left_out is the number of
 * those before that were not; else this one is counted, and *left_out is unchanged. */
bool web_note_limit_take(struct web_note_limit *limit, const char *account, int64_t now_ns,
                         uint32_t *left_out);

#endif
