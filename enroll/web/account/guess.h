/* Slows down who guesses passwords or codes. Failures are counted for the name of the account, for
 * the address of the client, and for the network of an IPv6 address. After three failures every
 * further one has to wait: 1 s, 2 s, 4 s and so on, at most a minute for an account or a network,
 * and a quarter of an hour for an address. So a stranger cannot keep an account locked for long,
 * and cannot try many accounts. A count is forgotten an hour after its last failure. A login clears
 * the count of the account, but not the others: otherwise somebody with an account could go on
 * guessing the others.
 *
 * The counts are in tables of fixed size. A keyed hash selects the entry of a name or an
 * address. If two of them have the same entry, they have the same delay. Names of accounts that do
 * not exist are counted, too, so that a delay does not show which accounts exist. Nothing is
 * allocated; the clock is passed in. */
#ifndef WEB_ACCOUNT_GUESS_H
#define WEB_ACCOUNT_GUESS_H

#include <sodium.h>
#include <stdint.h>
#include <sys/socket.h>

enum {
    WEB_GUESS_FREE = 3, /* failures without a delay */
    WEB_GUESS_ACCOUNT_MOST_S = 60,
    WEB_GUESS_ADDRESS_MOST_S = 900,
    WEB_GUESS_NETWORK_MOST_S = 60,
    WEB_GUESS_FORGET_S = 3600,
    WEB_GUESS_ACCOUNTS = 64,
    WEB_GUESS_ADDRESSES = 1024,
};

struct web_guess_count {
    uint32_t failures;
    int64_t last_ns; /* of the last failure */
};

struct web_guess {
    uint8_t key[crypto_shorthash_KEYBYTES];
    struct web_guess_count accounts[WEB_GUESS_ACCOUNTS];
    struct web_guess_count addresses[WEB_GUESS_ADDRESSES], networks[WEB_GUESS_ADDRESSES];
};

/* Forgets everything and chooses a random key. sodium_init() has to be called before. */
void web_guess_init(struct web_guess *guess);

/* Nanoseconds until this account may be tried from this address; 0: now. The first 64 bits
 * of an IPv6 address are its network: a client can choose the others. But all clients in a building
 * may have the same network, so its delay is short. All addresses of other families than IPv4 and
 * IPv6 count as one address. */
int64_t web_guess_wait_ns(const struct web_guess *guess, const char *account,
                          const struct sockaddr *address, int64_t now_ns);

/* Counts a failure. */
void web_guess_failed(struct web_guess *guess, const char *account, const struct sockaddr *address,
                      int64_t now_ns);

/* Forgets the failures of the account after a login. */
void web_guess_passed(struct web_guess *guess, const char *account);

#endif
