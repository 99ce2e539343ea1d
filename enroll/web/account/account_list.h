/* The accounts in memory, and their JSON text. Internal to enroll/web/account. */
#ifndef WEB_ACCOUNT_ACCOUNT_LIST_H
#define WEB_ACCOUNT_ACCOUNT_LIST_H

#include "enroll/web/account/account.h"

struct web_account_list {
    size_t n;
    struct web_account items[WEB_ACCOUNTS_MOST];
};

/* Reads the text of the file `path`, whose name is only for the fault. -EBADMSG with a fault; then
 * *out is unchanged. */
int web__account_list_read(const char *text, size_t size, const char *path,
                           struct web_account_list *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The text of the file, which the caller frees with free(); NULL: there is no memory. */
char *web__account_list_text(const struct web_account_list *list);

#endif
