#include "firmware/bus/call_rate.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "drivers/base/times.h"

void iso_call_rate_init(struct iso_call_rate *rate, int64_t now_ns)
{
    *rate = (struct iso_call_rate){.newcomers = {ISO_CALL_RATE_BURST, now_ns},
                                   .messages = {ISO_CALL_RATE_BURST, now_ns}};
}

static bool take(struct iso_call_allowance *allowance, double per_s, int64_t now_ns)
{
    const double waited_s = (double)(now_ns - allowance->t_ns) / (double)ISO_NS_PER_S;
    allowance->calls = fmin(ISO_CALL_RATE_BURST, allowance->calls + per_s * waited_s);
    allowance->t_ns = now_ns;
    if (allowance->calls < 1.0) {
        return false;
    }
    allowance->calls -= 1.0;
    return true;
}

bool iso_call_rate_take(struct iso_call_rate *rate, const char *client, int64_t now_ns)
{
    int oldest = 0;
    for (int i = 0; i < ISO_CALL_RATE_CLIENTS; i++) {
        if (strcmp(rate->clients[i].name, client) == 0) {
            return take(&rate->clients[i].allowance, ISO_CALL_RATE_PER_S, now_ns);
        }
        if (rate->clients[i].allowance.t_ns < rate->clients[oldest].allowance.t_ns) {
            oldest = i;
        }
    }
    if (strlen(client) >= ISO_CALL_RATE_NAME_SIZE ||
        !take(&rate->newcomers, ISO_CALL_RATE_NEWCOMER_PER_S, now_ns)) {
        return false;
    }
    (void)snprintf(rate->clients[oldest].name, ISO_CALL_RATE_NAME_SIZE, "%s", client);
    rate->clients[oldest].allowance = (struct iso_call_allowance){ISO_CALL_RATE_BURST - 1, now_ns};
    return true;
}

bool iso_call_rate_take_message(struct iso_call_rate *rate, int64_t now_ns)
{
    return take(&rate->messages, ISO_CALL_RATE_MESSAGES_PER_S, now_ns);
}
