
#[test]
fn the_torque_is_that_of_the_model_and_the_sum_of_its_parts() {
    compare("torque", &TORQUE, &of_motion(T.len(), robot::torque));
    let mut sum = of_motion(T.len(), robot::rigid_body_torque);
    for (sum, more) in sum.iter_mut().zip(of_motion(T.len(), robot::friction_torque)) {
        sum.iter_mut().zip(more).for_each(|(s, m)| *s += m);
    }
    compare("torque by parts", &TORQUE, &sum);
}
