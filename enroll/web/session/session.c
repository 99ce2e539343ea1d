#include "enroll/web/session/session.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

static const int64_t SECOND_NS = 1000000000;

static void hash_of(const char *token, uint8_t hash[32])
{
    crypto_generichash(hash, 32, (const unsigned char *)token, strlen(token), NULL, 0);
}

static bool is_alive(const struct web_session *session, int64_t now_ns)
{
    return session->id != 0 && now_ns - session->used_ns < WEB_SESSION_IDLE_S * SECOND_NS &&
           now_ns - session->begun_ns < WEB_SESSION_LIFE_S * SECOND_NS;
}

/* The entry for a new session: a free one, else the one that was used least recently; if the
 * account has its share already, one of its own. */
static struct web_session *make_room(struct web_sessions *sessions, const char *account,
                                     int64_t now_ns)
{
    struct web_session *oldest = NULL, *own = NULL, *unused = NULL;
    int n_own = 0;

    for (int i = 0; i < WEB_SESSIONS_MOST; i++) {
        struct web_session *s = &sessions->items[i];
        if (!is_alive(s, now_ns)) {
            unused = s;
            continue;
        }
        if (!oldest || s->used_ns < oldest->used_ns) {
            oldest = s;
        }
        if (strcmp(s->account, account) == 0) {
            n_own++;
            if (!own || s->used_ns < own->used_ns) {
                own = s;
            }
        }
    }
    if (n_own >= WEB_SESSIONS_OF_ACCOUNT) {
        return own;
    }
    return unused ? unused : oldest;
}

uint64_t web_session_begin(struct web_sessions *sessions, const struct web_account *account,
                           int64_t now_ns, char token[WEB_SESSION_TOKEN_SIZE])
{
    struct web_session *session = make_room(sessions, account->name, now_ns);
    uint8_t bytes[32];

    randombytes_buf(bytes, sizeof bytes);
    sodium_bin2base64(token, WEB_SESSION_TOKEN_SIZE, bytes, sizeof bytes,
                      sodium_base64_VARIANT_URLSAFE_NO_PADDING);
    sodium_memzero(bytes, sizeof bytes);
    *session = (struct web_session){
        .id = ++sessions->last_id, .role = account->role, .begun_ns = now_ns, .used_ns = now_ns};
    strcpy(session->account, account->name);
    hash_of(token, session->hash);
    return session->id;
}

const struct web_session *web_session_use(struct web_sessions *sessions, const char *token,
                                          int64_t now_ns)
{
    uint8_t hash[32];

    hash_of(token, hash);
    for (int i = 0; i < WEB_SESSIONS_MOST; i++) {
        struct web_session *s = &sessions->items[i];
        if (is_alive(s, now_ns) && sodium_memcmp(s->hash, hash, sizeof hash) == 0) {
            s->used_ns = now_ns;
            return s;
        }
    }
    return NULL;
}

bool web_session_goes_on(const struct web_sessions *sessions, uint64_t id, int64_t now_ns)
{
    for (int i = 0; id != 0 && i < WEB_SESSIONS_MOST; i++) {
        if (sessions->items[i].id == id) {
            return is_alive(&sessions->items[i], now_ns);
        }
    }
    return false;
}

void web_session_end(struct web_sessions *sessions, uint64_t id)
{
    for (int i = 0; i < WEB_SESSIONS_MOST; i++) {
        if (sessions->items[i].id == id) {
            sodium_memzero(&sessions->items[i], sizeof sessions->items[i]);
        }
    }
}

void web_session_end_account(struct web_sessions *sessions, const char *account, uint64_t except)
{
    for (int i = 0; i < WEB_SESSIONS_MOST; i++) {
        struct web_session *s = &sessions->items[i];
        if (s->id != 0 && s->id != except && strcmp(s->account, account) == 0) {
            sodium_memzero(s, sizeof *s);
        }
    }
}

bool web_session_cookie_token(const char *header, char token[WEB_SESSION_TOKEN_SIZE])
{
    static const char name[] = WEB_SESSION_COOKIE "=";
    const char *value = NULL;
    size_t length = 0;

    while (*header) {
        header += strspn(header, " ;\t");
        if (strncmp(header, name, sizeof name - 1) == 0) {
            if (value) {
                return false;
            }
            value = header + sizeof name - 1;
            length = strcspn(value, ";");
        }
        header += strcspn(header, ";");
    }
    if (!value || length != WEB_SESSION_TOKEN_SIZE - 1) {
        return false;
    }
    memcpy(token, value, length);
    token[length] = '\0';
    return true;
}

const char *web_session_set_cookie(const char *token, char text[WEB_SESSION_SET_COOKIE_SIZE])
{
    snprintf(text, WEB_SESSION_SET_COOKIE_SIZE,
             WEB_SESSION_COOKIE "=%s; Path=/; Secure; HttpOnly; SameSite=Strict%s",
             token ? token : "", token ? "" : "; Max-Age=0");
    return text;
}
