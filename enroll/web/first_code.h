/* The code for the first account, which the server makes by itself (option --first-code): for an
 * image of the appliance, where nobody can run `isotherm web setup`. While there is no account, a
 * code waits (setup_code.h), but for no longer than an hour after the start of the server: a door
 * in service that never gets an account must not offer one to its visitors. Each code is printed on
 * standard error, which is the journal, and is in the file "setup-code" of the folder that systemd
 * has made for the service (RuntimeDirectory=), for the screen and a unit of the image that shows
 * it on the console: the group of the server may read it, and nobody else. The file goes when there
 * is an account, or when root has made another code.
 *
 * A factory reset empties the folder of the state. A server that still runs then ends with -ESTALE,
 * also without the option: the service manager starts it anew, and it forgets the accounts and
 * sessions that it has in memory. */
#ifndef WEB_FIRST_CODE_H
#define WEB_FIRST_CODE_H

#include <stdbool.h>
#include <stdint.h>
#include <systemd/sd-event.h>

struct web_accounts;   /* enroll/web/account/account.h */
struct web_first_code; /* owned by who has made it */

enum { WEB_FIRST_CODE_HELD_S = 3600 }; /* after the start */

struct web_first_code_setup {
    sd_event *event;
    const struct web_accounts *accounts;
    const char *accounts_path, *code_path; /* their files; the caller keeps the texts */
    bool makes_codes;                      /* --first-code */
    int64_t (*now_s)(void);                /* seconds since 1970; NULL: the clock */
    int64_t (*up_s)(void);                 /* seconds that never jump; NULL: since the boot */
    uint64_t every_us;                     /* between two looks; 0: two seconds */
};

/* Looks at once, and then again and again. -ENOMEM, or an errno of sd-event. */
int web_first_code_new(const struct web_first_code_setup *setup, struct web_first_code **out)
    __attribute__((warn_unused_result));

/* Removes the file for the screen, and frees. NULL is accepted. */
void web_first_code_free(struct web_first_code *first);

#endif
