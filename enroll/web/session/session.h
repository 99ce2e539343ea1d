/* The sessions of people who have logged in. They are in memory only: a restart ends all of them.
 * A session is named by a token of 256 random bits, which only the browser has; the table keeps a
 * hash of it. Nothing is allocated; the clock (nanoseconds, monotonic) is passed in. */
#ifndef WEB_SESSION_SESSION_H
#define WEB_SESSION_SESSION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "enroll/web/account/account.h"

enum {
    WEB_SESSIONS_MOST = 64,        /* the one that was used least recently makes room */
    WEB_SESSIONS_OF_ACCOUNT = 8,   /* the same for each account */
    WEB_SESSION_IDLE_S = 30 * 60,  /* without a request */
    WEB_SESSION_LIFE_S = 12 * 3600 /* from the login on */
};
enum { WEB_SESSION_TOKEN_SIZE = 43 + 1 }; /* base64url of 32 bytes, with the NUL */

#define WEB_SESSION_COOKIE "__Host-isotherm"

struct web_session {
    uint64_t id; /* 1, 2, ...: never used again; 0: this entry of the table is free */
    uint8_t hash[32];
    char account[WEB_ACCOUNT_NAME_SIZE];
    enum web_role role;
    int64_t begun_ns, used_ns;
};

struct web_sessions {
    uint64_t last_id;
    struct web_session items[WEB_SESSIONS_MOST];
};

/* Begins a session of an account and writes its token. Returns its id. An all-zero *sessions has no
 * sessions. */
uint64_t web_session_begin(struct web_sessions *sessions, const struct web_account *account,
                           int64_t now_ns, char token[WEB_SESSION_TOKEN_SIZE]);

/* The session of a token, which counts as used now; NULL if there is none or it has ended. The
 * pointer is valid until the next call of a function that may end sessions. */
const struct web_session *web_session_use(struct web_sessions *sessions, const char *token,
                                          int64_t now_ns);

/* Whether the session of this id goes on. Does not count as use. */
bool web_session_goes_on(const struct web_sessions *sessions, uint64_t id, int64_t now_ns);

/* Ends a session; one that has ended already is accepted. */
void web_session_end(struct web_sessions *sessions, uint64_t id);

/* Ends all sessions of an account except the one of the id `except` (0: none). Called when the
 * account gets another role or password, or is removed. */
void web_session_end_account(struct web_sessions *sessions, const char *account, uint64_t except);

/* Finds the token in the header "Cookie". Returns false if there is none, if it has the wrong
 * length or if there are several. */
bool web_session_cookie_token(const char *header, char token[WEB_SESSION_TOKEN_SIZE]);

/* Writes the header "Set-Cookie": a cookie that ends with the browser, or for a NULL token one that
 * removes it. Returns the text. */
enum { WEB_SESSION_SET_COOKIE_SIZE = 160 };
const char *web_session_set_cookie(const char *token, char text[WEB_SESSION_SET_COOKIE_SIZE]);

#endif
