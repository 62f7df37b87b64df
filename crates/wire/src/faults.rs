//! iceoryx2's reasons for refusing something, told apart by type: every pattern has its own errors with much the same
//! variants, and what matters here is only which of a handful of cases it is.

use std::fmt::Debug;

use iceoryx2::port::listener::ListenerCreateError;
use iceoryx2::port::notifier::NotifierCreateError;
use iceoryx2::port::publisher::PublisherCreateError;
use iceoryx2::port::subscriber::SubscriberCreateError;
use iceoryx2::service::builder::event::{EventCreateError, EventOpenError, EventOpenOrCreateError};
use iceoryx2::service::builder::publish_subscribe::{
    PublishSubscribeCreateError, PublishSubscribeOpenError, PublishSubscribeOpenOrCreateError,
};
use iceoryx2::service::builder::request_response::{
    RequestResponseCreateError, RequestResponseOpenError, RequestResponseOpenOrCreateError,
};
use iceoryx2::service::port_factory::client::ClientCreateError;
use iceoryx2::service::port_factory::server::ServerCreateError;

/// What a refusal comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// It is not there.
    Missing,
    /// It is being made, or taken down, at this moment: another try will tell.
    InFlux,
    /// All its places are taken.
    Full,
    /// It was made by another version, of ours or of iceoryx2.
    OtherVersion,
    /// It is there but not whole: its maker has died, or speaks another version of iceoryx2.
    HalfMade,
    /// Anything else.
    Other,
}

/// An error of iceoryx2.
pub(crate) trait Refusal: Debug {
    /// What it comes to.
    fn fault(&self) -> Fault;
}

/// Errors by case; what is not listed is [`Fault::Other`].
macro_rules! refusal {
    ($error:ident: $($fault:ident: $($variant:ident)|+;)*) => {
        impl Refusal for $error {
            fn fault(&self) -> Fault {
                match self {
                    $($(Self::$variant)|+ => Fault::$fault,)*
                    _ => Fault::Other,
                }
            }
        }
    };
}

/// Errors of opening what may have to be made first.
macro_rules! either {
    ($error:ident: $open:ident | $create:ident) => {
        impl Refusal for $error {
            fn fault(&self) -> Fault {
                match self {
                    Self::$open(error) => error.fault(),
                    Self::$create(error) => error.fault(),
                    Self::SystemInFlux => Fault::InFlux,
                }
            }
        }
    };
}

refusal! { PublishSubscribeOpenError:
    Missing: DoesNotExist;
    InFlux: IsMarkedForDestruction;
    Full: ExceedsMaxNumberOfNodes;
    OtherVersion: VersionMismatch | IncompatibleTypes | IncompatibleMessagingPattern | IncompatibleAttributes
        | IncompatibleOverflowBehavior | DoesNotSupportRequestedMinBufferSize | DoesNotSupportRequestedMinHistorySize
        | DoesNotSupportRequestedMinSubscriberBorrowedSamples | DoesNotSupportRequestedAmountOfPublishers
        | DoesNotSupportRequestedAmountOfSubscribers | DoesNotSupportRequestedAmountOfNodes;
    HalfMade: ServiceInCorruptedState | HangsInCreation;
}
refusal! { PublishSubscribeCreateError:
    InFlux: AlreadyExists | IsBeingCreatedByAnotherInstance;
    HalfMade: ServiceInCorruptedState | HangsInCreation;
}
either! { PublishSubscribeOpenOrCreateError: PublishSubscribeOpenError | PublishSubscribeCreateError }

refusal! { RequestResponseOpenError:
    Missing: DoesNotExist;
    InFlux: IsMarkedForDestruction;
    Full: ExceedsMaxNumberOfNodes;
    OtherVersion: VersionMismatch | IncompatibleRequestOrResponseType | IncompatibleMessagingPattern
        | IncompatibleAttributes | IncompatibleOverflowBehaviorForRequests | IncompatibleOverflowBehaviorForResponses
        | IncompatibleBehaviorForFireAndForgetRequests | DoesNotSupportRequestedAmountOfClientRequestLoans
        | DoesNotSupportRequestedAmountOfActiveRequestsPerClient | DoesNotSupportRequestedResponseBufferSize
        | DoesNotSupportRequestedAmountOfServers | DoesNotSupportRequestedAmountOfClients
        | DoesNotSupportRequestedAmountOfNodes | DoesNotSupportRequestedAmountOfBorrowedResponsesPerPendingResponse;
    HalfMade: ServiceInCorruptedState | HangsInCreation;
}
refusal! { RequestResponseCreateError:
    InFlux: AlreadyExists | IsBeingCreatedByAnotherInstance;
    HalfMade: ServiceInCorruptedState | HangsInCreation;
}
either! { RequestResponseOpenOrCreateError: RequestResponseOpenError | RequestResponseCreateError }

refusal! { EventOpenError:
    Missing: DoesNotExist;
    InFlux: IsMarkedForDestruction;
    Full: ExceedsMaxNumberOfNodes;
    OtherVersion: VersionMismatch | IncompatibleMessagingPattern | IncompatibleAttributes | IncompatibleDeadline
        | IncompatibleNotifierCreatedEvent | IncompatibleNotifierDroppedEvent | IncompatibleNotifierDeadEvent
        | DoesNotSupportRequestedAmountOfNotifiers | DoesNotSupportRequestedAmountOfListeners
        | DoesNotSupportRequestedMaxEventId | DoesNotSupportRequestedAmountOfNodes;
    HalfMade: ServiceInCorruptedState | HangsInCreation;
}
refusal! { EventCreateError:
    InFlux: AlreadyExists | IsBeingCreatedByAnotherInstance;
    HalfMade: ServiceInCorruptedState;
}
either! { EventOpenOrCreateError: EventOpenError | EventCreateError }

refusal! { PublisherCreateError: Full: ExceedsMaxSupportedPublishers; }
refusal! { SubscriberCreateError: Full: ExceedsMaxSupportedSubscribers; }
refusal! { ClientCreateError: Full: ExceedsMaxSupportedClients; }
refusal! { ServerCreateError: Full: ExceedsMaxSupportedServers; }
refusal! { NotifierCreateError: Full: ExceedsMaxSupportedNotifiers; }
refusal! { ListenerCreateError: Full: ExceedsMaxSupportedListeners; }

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_case_of_any_pattern_is_the_same_fault() {
        let opened = [
            PublishSubscribeOpenError::DoesNotExist.fault(),
            RequestResponseOpenError::DoesNotExist.fault(),
            EventOpenOrCreateError::EventOpenError(EventOpenError::DoesNotExist).fault(),
        ];
        assert_eq!(opened, [Fault::Missing; 3]);
        let created = [
            PublishSubscribeOpenOrCreateError::SystemInFlux.fault(),
            PublishSubscribeCreateError::AlreadyExists.fault(),
            RequestResponseCreateError::IsBeingCreatedByAnotherInstance.fault(),
        ];
        assert_eq!(created, [Fault::InFlux; 3]);
        assert_eq!(SubscriberCreateError::ExceedsMaxSupportedSubscribers.fault(), Fault::Full);
        // A word that two cases share tells nothing: this buffer is not a house.
        assert_eq!(SubscriberCreateError::BufferSizeExceedsMaxSupportedBufferSizeOfService.fault(), Fault::Other);
    }
}
