/* The daemon on the system bus, by cockpit.dbus: firmware/contract/contract.h.
 *
 * Each page has a connection of its own. With {bus: 'system'}, Cockpit would use one connection for
 * all pages of a login: a claim would outlive the page, and View signals of one page would end with
 * those of another. With an address, the connection ends with the page, also if the browser crashes,
 * and the daemon then ends the claim. */

import {Fault} from './fault.js';

const NAME = 'org.isotherm.Isotherm';
const PATH = '/org/isotherm/Door0';
const INTERFACE = 'org.isotherm.Door';

/* Errors of the contract and of the bus, as the codes of the web server. */
const CODES = {
    'org.isotherm.Error.AlreadyInUse': 'camera-in-use',
    'org.isotherm.Error.NoSuchPerson': 'no-such-person',
    'org.isotherm.Error.NoActionInProgress': 'no-enrolment',
    'org.isotherm.Error.ActionInProgress': 'enrolment-running',
    'org.isotherm.Error.InvalidName': 'invalid-name',
    'org.isotherm.Error.NameInUse': 'name-in-use',
    'org.isotherm.Error.InvalidArgument': 'invalid-limits',
    'org.isotherm.Error.Conflict': 'policy-changed',
    'org.isotherm.Error.TooManyCalls': 'daemon-busy',
    'org.isotherm.Error.GalleryFull': 'gallery-full',
    'org.isotherm.Error.LockedOut': 'locked-out',
    'org.isotherm.Error.Storage': 'storage',
    'org.freedesktop.DBus.Error.AccessDenied': 'not-allowed',
    'org.freedesktop.DBus.Error.ServiceUnknown': 'no-daemon',
    'org.freedesktop.DBus.Error.NameHasNoOwner': 'no-daemon',
    'org.freedesktop.DBus.Error.NoReply': 'no-daemon',
};

const LIMITS = {
    valid_from_s: ['valid-from', 'x'],
    valid_until_s: ['valid-until', 'x'],
    expired: ['expired', 'b'],
    poses: ['poses', 'b'],
    allow_duplicate: ['allow-duplicate', 'b'],
    consent: ['consent', 'b']
};

/* What Cockpit says about a channel that it has closed. */
const PROBLEMS = {
    'access-denied': 'not-allowed',
    'not-found': 'no-daemon',
};

/* Where the system bus is, unless the environment says something else. */
const SYSTEM_BUS = 'unix:path=/run/dbus/system_bus_socket';

function fault(error) {
    const code = CODES[error?.name] ?? PROBLEMS[error?.problem] ?? 'no-connection';
    return new Fault(error?.name && !CODES[error.name] ? error.name : code, { detail: error?.message ?? '' });
}

export class DoorBus {
    #cockpit;
    #client = null;  /* the open channel; null: the next call opens one */
    #opening = null; /* a promise of it */
    #listeners = new Set();

    constructor(cockpit) { this.#cockpit = cockpit; }

    async #address() {
        try {
            const words = ['printenv', 'DBUS_SYSTEM_BUS_ADDRESS'];
            return (await this.#cockpit.spawn(words, { superuser: 'try', err: 'ignore' })).trim() || SYSTEM_BUS;
        } catch {
            return SYSTEM_BUS; /* printenv says by its exit code that there is no such variable */
        }
    }

    /* Cockpit closes a channel whose daemon does not run, and does not open it again. */
    #open() {
        this.#opening ??= this.#address().then((address) => {
            const client = this.#cockpit.dbus(NAME, { bus: 'none', address, superuser: 'try' });
            client.addEventListener('close', () => {
                this.#client = null;
                this.#opening = null;
            });
            client.subscribe({ interface: INTERFACE, path: PATH }, (path, iface, name, args) => {
                [...this.#listeners].forEach((listener) => listener(name, args));
            });
            this.#client = client;
            return client;
        });
        return this.#opening;
    }

    close() { this.#client?.close(); }

    /* Calls a method; resolves to its results. Throws a Fault. */
    async call(method, args, type, timeout = 10000) {
        /* A page that goes away sends its calls at once, or not at all. */
        const client = this.#client ?? await this.#open();
        try {
            return await client.call(PATH, INTERFACE, method, args, {...(type && { type }), timeout });
        } catch (error) {
            throw fault(error);
        }
    }

    /* Whether the bus lets this user call a method. Any other answer than a refusal means yes. */
    async allows(method, args) {
        try {
            await this.call(method, args);
            return true;
        } catch ({ code }) {
            return code !== 'not-allowed' && code !== 'no-daemon';
        }
    }

    /* The values of a dictionary, without their types. */
    plain(dictionary) {
        return Object.fromEntries(Object.entries(dictionary ?? {}).map(([key, value]) => [key, value?.v ?? value]));
    }

    async values(method) { return this.plain((await this.call(method, []))[0]); }

    /* Options of the contract from members of the API. */
    options(wish) {
        return Object.fromEntries(
            Object.entries(LIMITS)
                .filter(([member]) => wish[member] !== undefined)
                .map(([member, [key, type]]) => [key, this.#cockpit.variant(type, wish[member])]));
    }

    /* Calls listener(name, args) for each signal; the result has remove(). */
    subscribe(listener) {
        this.#listeners.add(listener);
        return { remove: () => this.#listeners.delete(listener) };
    }

    /* The document that `isotherm doctor --json` prints. */
    async doctor(text) {
        try {
            return JSON.parse(text);
        } catch {
            throw new Fault('internal', { detail: 'isotherm doctor printed no JSON document' });
        }
    }
}
