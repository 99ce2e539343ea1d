/* The daemon on the system bus, by cockpit.dbus: firmware/contract/contract.h. */

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
    allow_duplicate: ['allow-duplicate', 'b']
};

export class DoorBus {
    #cockpit;
    #client;

    constructor(cockpit) {
        this.#cockpit = cockpit;
        this.#client = cockpit.dbus(NAME, { bus: 'system', superuser: 'try' });
    }

    /* Calls a method; resolves to its results. Throws a Fault. */
    async call(method, args, type, timeout = 10000) {
        try {
            return await this.#client.call(PATH, INTERFACE, method, args, {...(type && { type }), timeout });
        } catch (error) {
            const code = CODES[error?.name] ?? (error?.problem === 'access-denied' ? 'not-allowed' : 'no-connection');
            throw new Fault(error?.name && !CODES[error.name] ? error.name : code, { detail: error?.message ?? '' });
        }
    }

    /* Whether the bus lets this user call a method. Any other answer than a refusal means yes. */
    async allows(method, args) {
        try {
            await this.call(method, args);
            return true;
        } catch (fault) {
            return fault.code !== 'not-allowed' && fault.code !== 'no-daemon';
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
        return this.#client.subscribe(
            { interface: INTERFACE, path: PATH }, (path, iface, name, args) => listener(name, args));
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
