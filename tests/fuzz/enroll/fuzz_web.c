/* What the web server reads before anybody has logged in: the cookie, the path, the query and the
 * headers of a request. And the file of the accounts. */
#include <stdlib.h>
#include <string.h>

#include "drivers/base/utf8.h"
#include "enroll/web/account/account_list.h"
#include "enroll/web/http/files.h"
#include "enroll/web/http/percent.h"
#include "enroll/web/session/origin.h"
#include "enroll/web/session/session.h"
#include "tests/fuzz/fuzz.h"

static int is_utf8(const char *text)
{
    uint32_t character;

    while (*text) {
        const int n = iso_utf8_decode(text, &character);
        if (n == 0) {
            return 0;
        }
        text += n;
    }
    return 1;
}

static void try_cookie(const char *text)
{
    char token[WEB_SESSION_TOKEN_SIZE] = "unchanged";

    if (web_session_cookie_token(text, token)) {
        fuzz_check(strlen(token) == WEB_SESSION_TOKEN_SIZE - 1, "a token has its length");
        fuzz_check(!strchr(token, ';'), "a token ends at the semicolon");
    } else {
        fuzz_check(strcmp(token, "unchanged") == 0, "the output is unchanged after a refusal");
    }
}

static void try_path(const uint8_t *data, size_t size)
{
    for (int is_form = 0; is_form < 2; is_form++) {
        char *text = (char *)fuzz_copy(data, size);
        const size_t n = strlen(text);
        if (web_percent_decode(text, is_form)) {
            fuzz_check(strlen(text) <= n && is_utf8(text), "a decoded text is UTF-8");
        }
        free(text);
    }
}

static void try_query(const uint8_t *data, size_t size)
{
    char *text = (char *)fuzz_copy(data, size);
    struct web_query query = {.n = 77};

    if (web_query_read(text, &query)) {
        fuzz_check(query.n <= WEB_QUERY_MOST, "a query has a limit");
        for (size_t i = 0; i < query.n; i++) {
            fuzz_check(is_utf8(query.items[i].name) && is_utf8(query.items[i].value),
                       "a query is UTF-8");
            fuzz_check(web_query_find(&query, query.items[i].name) == query.items[i].value,
                       "each name is there once");
        }
    } else {
        fuzz_check(query.n == 77, "the output is unchanged after a refusal");
    }
    free(text);
}

static void try_headers(const char *text)
{
    static const struct web_file file = {.etag = "\"0123456789abcdef0123456789abcdef\""};
    const struct web_origin origin = {.host = "door.test", .origin = text};
    const struct web_origin site = {.host = "door.test", .sec_fetch_site = text};

    if (web__file_is_unchanged(&file, text)) {
        fuzz_check(strchr(text, '*') || strlen(text) >= strlen(file.etag),
                   "a tag is compared whole");
    }
    fuzz_check(!web_origin_may_change(&origin) || strlen(text) == strlen("https://door.test"),
               "an origin is compared whole");
    fuzz_check(!web_origin_may_change(&site) || strcmp(text, "same-origin") == 0,
               "only the own pages may change something");
}

static void try_accounts(const char *text, size_t size)
{
    static struct web_account_list list;
    struct iso_fault fault;

    list.n = 77;
    if (web__account_list_read(text, size, "accounts", &list, &fault) == 0) {
        char *again = web__account_list_text(&list);
        struct web_account_list twice;
        fuzz_check(again &&
                       web__account_list_read(again, strlen(again), "again", &twice, NULL) == 0,
                   "accounts that were read can be written and read");
        fuzz_check(twice.n == list.n, "no account is lost");
        free(again);
    } else {
        fuzz_check(list.n == 77, "the output is unchanged after an error");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = (char *)fuzz_copy(data, size);

    try_cookie(text);
    try_path(data, size);
    try_query(data, size);
    try_headers(text);
    try_accounts(text, size);
    free(text);
    return 0;
}
