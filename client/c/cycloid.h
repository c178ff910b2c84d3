/* Cycloid for engines and other languages: the client library and offline worlds, in C99.
 *
 * Handles are opaque. Strings and arrays that go in are copied; what comes out is copied into the
 * caller's memory. No exception leaves a call. A struct that begins with struct_bytes says its
 * size, set by the caller, which ends where a field does. So a newer library understands older
 * callers: fields that they do not know have their defaults. Of a newer caller's struct it neither
 * reads nor writes the fields that it does not know itself: they stay as they are. cycloid_pose
 * and cycloid_event have no size, for they come in arrays, and are fixed for ever. A handle is used
 * by one thread at a time; different handles are independent.
 */
#ifndef CYCLOID_H
#define CYCLOID_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32)
#define CYCLOID_API __declspec(dllexport)
#else
#define CYCLOID_API __attribute__((visibility("default")))
#endif

/* Of this header; cycloid_abi_version() is that of the library. Grows when functions or fields are
 * added; what there is never changes. */
#define CYCLOID_ABI_VERSION 3

typedef int32_t cycloid_status;
enum {
  CYCLOID_OK = 0,
  CYCLOID_INVALID = 1, /* An argument; nothing has changed. */
  CYCLOID_SCENE = 2,   /* No such scene, or one that cannot run. */
  CYCLOID_BUFFER = 3,  /* The caller's memory is too small; the count says how much is there. */
  CYCLOID_STATE = 4,   /* Not now: not connected yet, or no state yet. */
  CYCLOID_MEMORY = 5,
  CYCLOID_STEP = 6,  /* The world cannot step, or the bytes are no state of this scene. */
  CYCLOID_FAILED = 7 /* Something else; the error text says what. */
};

/* Why the last call on this thread that failed did. Writes at most `capacity` bytes with the final
 * 0 and returns how many the whole text takes. */
CYCLOID_API uint32_t cycloid_last_error(char* text, uint32_t capacity);
CYCLOID_API uint32_t cycloid_abi_version(void);
/* Two peers play in lockstep only where this is equal. */
CYCLOID_API uint32_t cycloid_solver_version(void);

/* Axes from -32767 to 32767, which is -1 to 1; button b is bit b. */
typedef struct cycloid_input {
  uint32_t struct_bytes;
  int16_t axes[4];
  uint16_t buttons;
  uint16_t reserved;
} cycloid_input;

/* Position in m, rotation as a quaternion x, y, z, w; in the plane z is 0 and it turns about z. The
 * same index with another generation is another body. */
typedef struct cycloid_pose {
  uint32_t index;
  uint32_t generation;
  float position[3];
  float rotation[4];
} cycloid_pose;

/* ---- A world without a network. ---- */

typedef struct cycloid_simulation cycloid_simulation;
typedef struct cycloid_saved cycloid_saved;

/* `scene`: a name of the catalogue, "half-pipe" or "pyramid:base=30", or a file. */
CYCLOID_API cycloid_status cycloid_simulation_create(const char* scene, cycloid_simulation** out);
CYCLOID_API void cycloid_simulation_destroy(cycloid_simulation* simulation);
CYCLOID_API uint32_t cycloid_simulation_seats(const cycloid_simulation* simulation);
CYCLOID_API uint64_t cycloid_simulation_tick(const cycloid_simulation* simulation);
CYCLOID_API uint64_t cycloid_simulation_digest(const cycloid_simulation* simulation);
/* One tick by one input for each seat, all of the same struct_bytes; `inputs` may be null where the
 * scene has no seats. */
CYCLOID_API cycloid_status cycloid_simulation_step(cycloid_simulation* simulation,
                                                   const cycloid_input* inputs, uint32_t count);
/* What the scene's own script lets a seat say for a tick; neutral where it says nothing. */
CYCLOID_API cycloid_status cycloid_simulation_scripted_input(const cycloid_simulation* simulation,
                                                             uint32_t seat, uint64_t tick,
                                                             cycloid_input* out);
/* Fills `*saved`, or makes one where it is null. Every bit comes back by restore. */
CYCLOID_API cycloid_status cycloid_simulation_save(const cycloid_simulation* simulation,
                                                   cycloid_saved** saved);
CYCLOID_API cycloid_status cycloid_simulation_restore(cycloid_simulation* simulation,
                                                      const cycloid_saved* saved);
CYCLOID_API void cycloid_saved_destroy(cycloid_saved* saved);
/* The exact state as bytes that travel and keep. The scene's digest comes first, by which decode
 * knows bytes of another scene; libraries before version 3 did not write it. `*count` becomes how
 * many bytes or poses there are, also where `capacity` is too small and nothing is written. */
CYCLOID_API cycloid_status cycloid_simulation_encode(const cycloid_simulation* simulation,
                                                     uint8_t* bytes, uint32_t capacity,
                                                     uint32_t* count);
CYCLOID_API cycloid_status cycloid_simulation_decode(cycloid_simulation* simulation,
                                                     const uint8_t* bytes, uint32_t count);
CYCLOID_API cycloid_status cycloid_simulation_read_poses(const cycloid_simulation* simulation,
                                                         cycloid_pose* poses, uint32_t capacity,
                                                         uint32_t* count);

/* ---- A client of a server. ---- */

typedef struct cycloid_client cycloid_client;

enum { CYCLOID_MODE_LOCKSTEP = 1, CYCLOID_MODE_SNAPSHOT = 2 };
enum { CYCLOID_PROFILE_EXACT = 1, CYCLOID_PROFILE_QUANTISED = 2 };
enum { CYCLOID_ANY_SEAT = -1, CYCLOID_SPECTATOR = -2 };

typedef struct cycloid_client_options {
  uint32_t struct_bytes;
  uint32_t mode;
  const char* host;  /* An address or a name. */
  const char* scene; /* The server's, as for cycloid_simulation_create. */
  const char* name;  /* For the server's log; at most 64 bytes. */
  const char* room;  /* Null: the only one, or the one that the token names. */
  const char* token; /* As `cycloid token` writes it; null: none. */
  const uint8_t* resume; /* 32 bytes that an earlier client gave out, or null. */
  uint32_t resume_bytes;
  uint32_t port;
  int32_t seat;
  uint32_t profile;
  uint32_t predict_ticks;         /* Most ticks to run ahead of the server, up to 64; 0: none. */
  uint32_t reconnect_deadline_ms; /* How long to try to come back to the seat; 0: not at all. */
  uint64_t ticks;                 /* Leave after so many; 0: stay. */
  uint32_t workers;               /* Threads of a step at most; changes no bit. */
  uint32_t scripted;              /* 1: the seat says what the scene's script says. */
} cycloid_client_options;

/* Sets every field but `struct_bytes`, which the caller has set, to its default. */
CYCLOID_API cycloid_status cycloid_client_options_init(cycloid_client_options* options);

CYCLOID_API cycloid_status cycloid_client_create(const cycloid_client_options* options,
                                                 cycloid_client** out);
/* Says goodbye where it is connected; takes at most about a second, or as long as the system's name
 * service takes where it is looking up the host. */
CYCLOID_API void cycloid_client_destroy(cycloid_client* client);
/* Begins to connect and returns at once; what comes of it shows in the state. Once for a client. */
CYCLOID_API cycloid_status cycloid_client_connect(cycloid_client* client);
/* Takes in and sends what is there; waits for at most so long where nothing is. Call it at least
 * once a frame of the game: nothing else does any work. */
CYCLOID_API cycloid_status cycloid_client_poll(cycloid_client* client, uint32_t wait_ms);
/* What my seat says from the next tick on that is not said yet, until this is called again. */
CYCLOID_API cycloid_status cycloid_client_send_input(cycloid_client* client,
                                                     const cycloid_input* input);
/* Begins to leave; poll on until the phase is CYCLOID_PHASE_OVER. */
CYCLOID_API cycloid_status cycloid_client_leave(cycloid_client* client);

enum {
  CYCLOID_PHASE_IDLE = 0,       /* Not connected yet. */
  CYCLOID_PHASE_CONNECTING = 1, /* Also between two connections. */
  CYCLOID_PHASE_LOADING = 2,    /* Let in; the state is on its way. */
  CYCLOID_PHASE_RUNNING = 3,
  CYCLOID_PHASE_OVER = 4
};
enum {
  CYCLOID_END_NONE = 0,
  CYCLOID_END_TICKS = 1,
  CYCLOID_END_BYE = 2, /* The server closed the match. */
  CYCLOID_END_STOPPED = 3,
  CYCLOID_END_REFUSED = 4,
  CYCLOID_END_DISCONNECTED = 5,
  CYCLOID_END_FAILED = 6
};

typedef struct cycloid_client_state {
  uint32_t struct_bytes;
  uint32_t phase;
  uint32_t end;     /* Why it is over. */
  uint32_t refusal; /* The server's code, docs/protocol.md; 0: none. */
  int32_t seat;
  uint32_t lead_ticks;
  int32_t early_ticks; /* Of my worst input, as the server says. */
  uint32_t tick_rate_millihertz;
  uint64_t tick;           /* Confirmed by the server. */
  uint64_t predicted_tick; /* Of the poses. */
  uint64_t digest;         /* Of the confirmed state. */
  uint64_t frames;
  uint64_t digests_compared;
  uint64_t mismatches;
  uint64_t resyncs;
  uint64_t inputs_sent;
  uint64_t inputs_replaced;
  uint64_t rollbacks;
  uint64_t ticks_resimulated;
  uint64_t reconnects;
} cycloid_client_state;

CYCLOID_API cycloid_status cycloid_client_read_state(const cycloid_client* client,
                                                     cycloid_client_state* out);
/* Why it is over, in words: as cycloid_last_error. */
CYCLOID_API uint32_t cycloid_client_reason(const cycloid_client* client, char* text,
                                           uint32_t capacity);
/* The 32 bytes that bring the seat back, once: keep them over a restart of the game. CYCLOID_STATE
 * where the server gave none. */
CYCLOID_API cycloid_status cycloid_client_read_resume(const cycloid_client* client, uint8_t* bytes,
                                                      uint32_t capacity, uint32_t* count);
/* The state to show: the predicted one where there are predictions. No poses until there was a
 * state; while another connection loads, those that were shown last. */
CYCLOID_API cycloid_status cycloid_client_read_poses(const cycloid_client* client,
                                                     cycloid_pose* poses, uint32_t capacity,
                                                     uint32_t* count);

/* The same at a time in ticks, such as 61.25: between two states that were shown, straight on for a
 * few ticks beyond the newest, which is of `predicted_tick`. To draw at any rate, go back from that
 * by the ticks that lie between two states (1 in lockstep) and on by the clock of the engine. For
 * pictures alone: never the state itself. No poses until there was a state. Since version 2. */
CYCLOID_API cycloid_status cycloid_client_read_poses_at(const cycloid_client* client, double tick,
                                                        cycloid_pose* poses, uint32_t capacity,
                                                        uint32_t* count);

enum {
  CYCLOID_EVENT_JOIN = 1, /* `subject` is the seat. */
  CYCLOID_EVENT_LEAVE = 2,
  CYCLOID_EVENT_KICK = 3,
  CYCLOID_EVENT_LOST = 4,
  CYCLOID_EVENT_RESUME = 5,
  CYCLOID_EVENT_INPUT_DELAY = 6,   /* `value` ticks from now on. */
  CYCLOID_EVENT_BODY_CREATED = 7,  /* `subject` is the index, `value` the generation. */
  CYCLOID_EVENT_BODY_DESTROYED = 8,
  CYCLOID_EVENT_NOTICE = 9,       /* `subject` is the kind, docs/protocol.md. */
  CYCLOID_EVENT_EVENTS_LOST = 10 /* `value` events were dropped: read more often. */
};

typedef struct cycloid_event {
  uint64_t tick;
  uint64_t value;
  uint32_t kind;
  uint32_t subject;
} cycloid_event;

/* Takes up to `capacity` events out, oldest first; `*count` becomes how many. */
CYCLOID_API cycloid_status cycloid_client_read_events(cycloid_client* client, cycloid_event* events,
                                                      uint32_t capacity, uint32_t* count);

#ifdef __cplusplus
}
#endif
#endif
