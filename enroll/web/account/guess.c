#include "enroll/web/account/guess.h"

#include <netinet/in.h>
#include <stdbool.h>
#include <string.h>

static const int64_t SECOND_NS = 1000000000;

void web_guess_init(struct web_guess *guess)
{
    memset(guess, 0, sizeof *guess);
    randombytes_buf(guess->key, sizeof guess->key);
}

static uint64_t hash_of(const struct web_guess *guess, const void *bytes, size_t size)
{
    uint64_t hash;

    _Static_assert(sizeof hash == crypto_shorthash_BYTES, "one hash is one number");
    crypto_shorthash((unsigned char *)&hash, bytes, size, guess->key);
    return hash;
}

static size_t account_entry(const struct web_guess *guess, const char *account)
{
    return hash_of(guess, account, strlen(account)) % WEB_GUESS_ACCOUNTS;
}

/* The entry of an address, or of its network: of an IPv6 address the first 64 bits. */
static size_t address_entry(const struct web_guess *guess, const struct sockaddr *address,
                            bool is_network)
{
    uint8_t bytes[16] = {0};

    if (address->sa_family == AF_INET) {
        memcpy(bytes, &((const struct sockaddr_in *)(const void *)address)->sin_addr, 4);
    } else if (address->sa_family == AF_INET6) {
        const struct in6_addr *v6 =
            &((const struct sockaddr_in6 *)(const void *)address)->sin6_addr;
        /* An IPv4 address that came through an IPv6 socket. */
        const bool is_mapped = IN6_IS_ADDR_V4MAPPED(v6);
        memcpy(bytes, v6->s6_addr + (is_mapped ? 12 : 0), is_mapped ? 4 : is_network ? 8 : 16);
    }
    return hash_of(guess, bytes, sizeof bytes) % WEB_GUESS_ADDRESSES;
}

static int64_t wait_ns(const struct web_guess_count *count, int64_t most_s, int64_t now_ns)
{
    int64_t delay_s = most_s, wait;

    if (count->failures < WEB_GUESS_FREE ||
        now_ns - count->last_ns > WEB_GUESS_FORGET_S * SECOND_NS) {
        return 0;
    }
    if (count->failures - WEB_GUESS_FREE < 20 &&
        (INT64_C(1) << (count->failures - WEB_GUESS_FREE)) < most_s) {
        delay_s = INT64_C(1) << (count->failures - WEB_GUESS_FREE);
    }
    wait = count->last_ns + delay_s * SECOND_NS - now_ns;
    return wait > 0 ? wait : 0;
}

int64_t web_guess_wait_ns(const struct web_guess *guess, const char *account,
                          const struct sockaddr *address, int64_t now_ns)
{
    const int64_t a = wait_ns(&guess->accounts[account_entry(guess, account)],
                              WEB_GUESS_ACCOUNT_MOST_S, now_ns);
    const int64_t b = wait_ns(&guess->addresses[address_entry(guess, address, false)],
                              WEB_GUESS_ADDRESS_MOST_S, now_ns);
    const int64_t c = wait_ns(&guess->networks[address_entry(guess, address, true)],
                              WEB_GUESS_NETWORK_MOST_S, now_ns);
    const int64_t longer = a > b ? a : b;

    return longer > c ? longer : c;
}

static void count_failure(struct web_guess_count *count, int64_t now_ns)
{
    if (now_ns - count->last_ns > WEB_GUESS_FORGET_S * SECOND_NS) {
        count->failures = 0;
    }
    if (count->failures < UINT32_MAX) {
        count->failures++;
    }
    count->last_ns = now_ns;
}

void web_guess_failed(struct web_guess *guess, const char *account, const struct sockaddr *address,
                      int64_t now_ns)
{
    count_failure(&guess->accounts[account_entry(guess, account)], now_ns);
    count_failure(&guess->addresses[address_entry(guess, address, false)], now_ns);
    count_failure(&guess->networks[address_entry(guess, address, true)], now_ns);
}

void web_guess_passed(struct web_guess *guess, const char *account)
{
    guess->accounts[account_entry(guess, account)] = (struct web_guess_count){0};
}
